"""Shapes of the structure: its modes, and what static loads bend it to."""

from typing import Any

import numpy as np
import pandas as pd

from flexsurr.beam import ModalBasis, element_frames, find_equilibrium, node_positions
from flexsurr.config.load import TipForce
from flexsurr.config.study import Study
from flexsurr.evaluation.cases import rest_state
from flexsurr.simulation.rhs import Array

SHAPE_COLUMNS = (
    "kind",
    "number",
    "omega_rad_s",
    "load_N",
    "model",
    "line",
    "node",
    "x_m",
    "y_m",
    "z_m",
)

MOST_MODES = 6

REACH = 0.2
"""How far a mode is drawn from where it is taken at most, of the length."""

STRIP = 0.1
"""Least width of the strip that shows twist, of the length."""


def shapes_table(study: Study, basis: ModalBasis) -> pd.DataFrame:
    """Modes of the reduced model, and both models in equilibrium under the study's static loads.

    Columns `SHAPE_COLUMNS`. Of kind "rest" and "mode" the lines "left", "axis" and "right" span a strip that
    shows the twist; its width is for the eye. Of kind "static" there is the axis, of "fom" and "rom". A
    mode is scaled so that the strip moves by `REACH` of the length at most. In the clamp's frame before it is
    turned [m]. Raises EquilibriumNotFound where a model buckles.
    """
    structure = basis.structure
    frames = [_strip(basis, basis.equilibrium, kind="rest", number=0, omega_rad_s=np.nan)]
    for k in range(min(MOST_MODES, basis.modes.shape[1])):
        q = basis.equilibrium + _scale(basis, basis.modes[:, k]) * basis.modes[:, k]
        frames.append(_strip(basis, q, kind="mode", number=k + 1, omega_rad_s=basis.omega_rad_s[k]))
    for number, load_N in enumerate(sorted(study.statics.tip_loads_N)):
        force = TipForce(force_N=load_N)
        eta = rest_state(basis, force)[: basis.modes.shape[1]]
        shapes = {"fom": find_equilibrium(structure, force), "rom": basis.modes @ eta}
        for model, q in shapes.items():
            line = _line(node_positions(structure, q), "axis")
            frames.append(line.assign(kind="static", number=number, load_N=load_N, model=model))
    table = pd.concat(frames, ignore_index=True).reindex(columns=list(SHAPE_COLUMNS))
    return table.astype({"omega_rad_s": float, "load_N": float})


def _strip(basis: ModalBasis, q: Array, **columns: Any) -> pd.DataFrame:
    """The axis and two edges at joint coordinates q (n,)."""
    lines = {name: _line(points, name) for name, points in _edges(basis, q).items()}
    return pd.concat(lines.values()).assign(model="rom", **columns)


def _edges(basis: ModalBasis, q: Array) -> dict[str, Array]:
    """(N + 1, 3) points of the strip's two edges and of its axis; a node turns as the element before it."""
    structure = basis.structure
    nodes, sideways = node_positions(structure, q), element_frames(structure, q)[:, :, 1]
    half = 0.5 * max(structure.chord_m, STRIP * structure.length_m) * np.vstack([sideways[:1], sideways])
    return {"left": nodes + half, "axis": nodes, "right": nodes - half}


def _scale(basis: ModalBasis, mode: Array) -> float:
    """The factor of a mode (n,) with which the strip moves by `REACH` of the length, to first order."""
    small = 1e-4 / float(np.max(np.abs(mode)))
    moved, rest = (_edges(basis, basis.equilibrium + step * mode) for step in (small, 0.0))
    furthest = max(float(np.linalg.norm(moved[name] - rest[name], axis=1).max()) for name in rest)
    return small * REACH * basis.structure.length_m / furthest


def _line(points: Array, name: str) -> pd.DataFrame:
    columns = dict(zip(("x_m", "y_m", "z_m"), points.T, strict=True))
    return pd.DataFrame({"line": name, "node": np.arange(len(points)), **columns})
