"""A grid of Mach numbers, and the weights by which what is known at its nodes is interpolated.

By Prandtl–Glauert's rule everything depends on the Mach number through β = √(1 − M²) alone, and smoothly; so
nodes are equally spaced in β, and Lagrange's polynomials in β pass through the nearest of them.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from flexsurr.aerodynamics.boundary import COMPILED
from flexsurr.aerodynamics.horseshoe import stretch_of
from flexsurr.simulation.rhs import Array

DEFAULT_NODES = 9
DEFAULT_POINTS = 3


class MachGrid(NamedTuple):
    """Nodes √(1 − M²) (K,), decreasing; each interpolation uses the `points` nearest of them."""

    nodes: Array
    points: int

    def machs(self) -> Array:
        """The Mach numbers (K,) of the nodes."""
        return np.sqrt(1.0 - self.nodes * self.nodes)


def mach_grid(low: float, high: float, nodes: int = DEFAULT_NODES, points: int = DEFAULT_POINTS) -> MachGrid:
    """Nodes from Mach `low` to `high`, both among them. Raises ValueError where that cannot be."""
    if not low < high or nodes < 2:
        raise ValueError(
            f"Mach numbers from {low:g} to {high:g} at {nodes} nodes: low < high and two nodes needed"
        )
    first, last = 1.0 / stretch_of(low), 1.0 / stretch_of(high)
    return _grid(np.linspace(first, last, nodes), points)


def fixed_machs(machs: Sequence[float], points: int = DEFAULT_POINTS) -> MachGrid:
    """These Mach numbers, increasing; of a single one the value is held everywhere."""
    nodes = np.array([1.0 / stretch_of(mach) for mach in machs])
    if nodes.size == 0 or np.any(np.diff(nodes) >= 0.0):
        raise ValueError(f"Mach numbers {list(machs)}: one or more are needed, increasing")
    return _grid(nodes, points)


def _grid(nodes: Array, points: int) -> MachGrid:
    if points < 1:
        raise ValueError(f"interpolation through {points} points; at least one is needed")
    return MachGrid(nodes, min(points, len(nodes)))


@njit(**COMPILED)
def write_weights(grid, mach, weights):
    """Write the weight of each of the K nodes at `mach` into the first K of `weights`, most of them 0."""
    nodes, points = grid
    count = nodes.size
    beta = math.sqrt(1.0 - mach * mach)
    passed = 0
    for k in range(count):
        weights[k] = 0.0
        if nodes[k] >= beta:
            passed = k + 1
    first = passed - points // 2
    first = max(min(first, count - points), 0)
    for k in range(first, first + points):
        weight = 1.0
        for j in range(first, first + points):
            if j != k:
                weight *= (beta - nodes[j]) / (nodes[k] - nodes[j])
        weights[k] = weight
