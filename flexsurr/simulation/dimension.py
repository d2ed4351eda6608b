"""The number of states as a constant of compilation.

With a few states the loops over them cost more than the sums inside; with their number known to the
compiler they are unrolled (a factor of five for two states). A tuple's length is part of its type, so a
tuple carries the number. Large systems gain nothing and would be compiled once for each size, so
theirs stays a variable.
"""

from typing import NamedTuple

from numba import types
from numba.extending import overload

from flexsurr.kernel_cache import not_compiled
from flexsurr.simulation.rhs import FLOATING_POINT, Array

LARGEST_CONSTANT = 8

LANES = 64
"""Trajectories that are stepped side by side: stages of two states then fit the first cache."""

# Sums keep their order: the newest stage comes last, so that a step waits for one multiplication only.
ORDERED = FLOATING_POINT - {"reassoc"}

Dimension = tuple[int, ...]


class SideBySide(NamedTuple):
    """The states of `LANES` trajectories, `one` of each: state i of trajectory b lies at i · LANES + b."""

    one: Dimension


def dimension(d: int) -> Dimension:
    """The constant d as a tuple of d zeros; empty if d is left a variable."""
    return (0,) * d if d <= LARGEST_CONSTANT else ()


def states(constant: Dimension | SideBySide, x: Array) -> int:
    """Number of states, of all trajectories: the constant if there is one, else the size of x.

    From compiled code only.
    """
    raise not_compiled("number of states", "states", constant)


@overload(states, jit_options={"error_model": "numpy"})
def _states(constant, x):
    if isinstance(constant, types.BaseNamedTuple):
        return lambda constant, x: len(constant.one) * LANES
    if len(constant) > 0:
        return lambda constant, x: len(constant)
    return lambda constant, x: x.size
