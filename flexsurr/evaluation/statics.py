"""Static deflection under dead tip loads, natural frequencies, and the shapes of both."""

from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from flexsurr.beam import (
    ModalBasis,
    elastica_tip,
    element_frames,
    find_equilibrium,
    natural_modes,
    node_positions,
    reduced_order,
    tip_position,
)
from flexsurr.beam.elastica import LARGEST_LOAD
from flexsurr.config.load import TipForce
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation.cases import rest_state
from flexsurr.evaluation.columns import FREQUENCY_COLUMNS, STATIC_COLUMNS
from flexsurr.evaluation.published import FREQUENCIES_RAD_S
from flexsurr.simulation.rhs import Array


def static_tip(study: Study, basis: ModalBasis) -> pd.DataFrame:
    """Tip position under dead tip loads along +z: exact elastica, full order, reduced order (Fig. 8).

    Columns `STATIC_COLUMNS`, one row per load, in the clamp's frame [m]. The exact curve is that of an
    inextensible beam that bends out of plane only and weighs nothing; for any other structure, and beyond
    F L²/EI = 100, the columns of the exact curve are NaN. Raises EquilibriumNotFound where a model buckles.
    """
    structure = basis.structure
    model = reduced_order(basis, "hamiltonian", "numpy")
    rows = []
    for load_N in sorted(study.statics.tip_loads_N):
        force = TipForce(force_N=load_N)
        fom = tip_position(structure, find_equilibrium(structure, force))
        rom = model.tip(rest_state(basis, force))
        x_exact, z_exact = _exact_tip(structure, load_N)
        rows.append((load_N, x_exact, z_exact, fom[0], fom[2], rom[0], rom[2]))
    return pd.DataFrame(rows, columns=list(STATIC_COLUMNS)).astype(float)


def natural_frequencies(basis: ModalBasis) -> pd.DataFrame:
    """Natural frequencies [rad/s] about the basis' equilibrium: full and reduced order (Table 3).

    Columns `FREQUENCY_COLUMNS` and exact_rad_s, one row per mode of the full-order model. NaN where
    the reduced model has no such mode, nothing is published, or no exact value is known. The exact ones
    are those of the straight clamped Euler-Bernoulli beam that bends out of plane only.
    """
    structure = basis.structure
    fom, _ = natural_modes(structure, basis.equilibrium)
    published_fom, published_rom = FREQUENCIES_RAD_S.get(structure.name, ((), ()))
    frame = pd.DataFrame({"structure": structure.name, "mode": np.arange(1, fom.size + 1), "fom_rad_s": fom})
    for name, values in (
        ("rom_rad_s", basis.omega_rad_s),
        ("published_fom_rad_s", published_fom),
        ("published_rom_rad_s", published_rom),
        ("exact_rad_s", _exact_frequencies(structure, fom.size)),
    ):
        frame[name] = pd.Series(np.asarray(values, dtype=float)).reindex(frame.index)
    return frame[[*FREQUENCY_COLUMNS, "exact_rad_s"]]


def _is_elastica(structure: Structure) -> bool:
    """Whether the structure is the plain cantilever that the closed forms describe."""
    return (
        structure.ordered_joints == ("out_of_plane",)
        and structure.uniform
        and structure.gravity_m_s2 == 0.0
        and structure.clamp_psi_deg == structure.clamp_theta_deg == structure.clamp_phi_deg == 0.0
    )


def _exact_tip(structure: Structure, load_N: float) -> tuple[float, float]:
    stiffness = structure.section_stiffness("out_of_plane")
    if not _is_elastica(structure) or stiffness is None:
        return (np.nan, np.nan)
    if abs(load_N) * structure.length_m**2 / stiffness > LARGEST_LOAD:
        return (np.nan, np.nan)
    x, z = elastica_tip(stiffness, structure.length_m, load_N)
    return float(x), float(z)


def _exact_frequencies(structure: Structure, count: int) -> Array:
    """ω_k = (λ_k/L)² √(EI/μ) with cos λ cosh λ = −1: the clamped-free Euler-Bernoulli beam."""
    stiffness, mass = structure.section_stiffness("out_of_plane"), structure.mass_per_length_kg_m
    if not _is_elastica(structure) or stiffness is None or mass is None:
        return np.empty(0)
    # cos λ + 1/cosh λ changes sign once between multiples of π and does not overflow
    roots = np.array(
        [
            brentq(lambda z: np.cos(z) + 1.0 / np.cosh(z), k * np.pi, (k + 1) * np.pi, xtol=1e-14)
            for k in range(count)
        ]
    )
    omega: Array = (roots / structure.length_m) ** 2 * np.sqrt(stiffness / mass)
    return omega


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
