"""The number of states as a constant of compilation.

With a few states the loops over them cost more than the sums inside; with their number known to the
compiler they are unrolled (a factor of five for two states). A tuple's length is part of its type, so a
tuple carries the number. Large systems gain nothing and would be compiled once for each size, so
theirs stays a variable.
"""

from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT

LARGEST_CONSTANT = 8

# Sums keep their order: the newest stage comes last, so that a step waits for one multiplication only.
ORDERED = FLOATING_POINT - {"reassoc"}

Dimension = tuple[int, ...]


def dimension(d: int) -> Dimension:
    """The constant d as a tuple of d zeros; empty if d is left a variable."""
    return (0,) * d if d <= LARGEST_CONSTANT else ()


@njit(error_model="numpy")
def states(constant, x):
    """Number of states: the constant if there is one, else the size of x."""
    return len(constant) if len(constant) > 0 else x.size
