"""What the loads of flexsurr.config.load exert on the chain, at a factor of 1."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from flexsurr.config.load import Constant, DistributedForce, Shape, TipForce, loaded_span
from flexsurr.config.structure import Structure
from flexsurr.simulation.history import factor
from flexsurr.simulation.rhs import Array

Load = TipForce | DistributedForce


class Forces(NamedTuple):
    """Dead forces on the elastic axis, in the clamp's frame before it is turned."""

    on_centres: Array  # (N, 3) on the elements' centres [N]
    on_tip: Array  # (3,) [N]


# ∫ of each shape from the clamp to ξ = x/L.
_INTEGRALS: dict[Shape, Callable[[Array], Array]] = {
    "uniform": lambda xi: xi,
    "linear": lambda xi: 0.5 * xi**2,
    "elliptic": lambda xi: 0.5 * (xi * np.sqrt(1.0 - xi**2) + np.arcsin(xi)),
    "one_minus_elliptic": lambda xi: xi - _INTEGRALS["elliptic"](xi),
}


def load_forces(structure: Structure, load: Load) -> Forces:
    """The forces of `load` at a factor of 1; distributed ones by eqs. 13 and 14.

    ValueError for a load outside the span.
    """
    on_centres, on_tip = np.zeros((structure.elements, 3)), np.zeros(3)
    if isinstance(load, TipForce):
        on_tip[:] = load.force_N * np.array(load.direction) / math.hypot(*load.direction)
        return Forces(on_centres, on_tip)
    span = structure.length_m
    ends = np.clip(np.linspace(0.0, span, structure.elements + 1), *loaded_span(load, span)) / span
    for axis, spread in enumerate(load.spreads):
        if spread is not None:
            on_centres[:, axis] = spread.force_N_m * span * np.diff(_INTEGRALS[spread.shape](ends))
    if load.acts_on == "tip":
        on_tip, on_centres = on_centres.sum(axis=0), np.zeros_like(on_centres)
    return Forces(on_centres, on_tip)


def static_forces(structure: Structure, load: Load | None, at_s: float | None = None) -> Forces:
    """The forces of a constant load, or of any load held as it is at `at_s` [s].

    ValueError for a load that changes with time where no instant is given.
    """
    if load is None:
        return Forces(np.zeros((structure.elements, 3)), np.zeros(3))
    if at_s is None:
        if not isinstance(load.history, Constant):
            raise ValueError(f"{load} changes with time: it has no static equilibrium")
        return load_forces(structure, load)
    held = factor(load.history, at_s)
    return Forces(*(held * forces for forces in load_forces(structure, load)))
