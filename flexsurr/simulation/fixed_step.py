"""Integration with a fixed step, for any one-step method.

A method is a NamedTuple of its workspaces; its class chooses the formula, as a kernel's class chooses
the equations.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.extending import overload

from flexsurr.kernel_cache import not_compiled
from flexsurr.simulation.dimension import ORDERED, Dimension, states
from flexsurr.simulation.rhs import Array, rhs
from flexsurr.simulation.tableaus import DOP853, RK4
from flexsurr.simulation.trajectory import COMPLETED, NOT_FINITE
from flexsurr.simulation.unrolled import dop853_step, rk4_step

# Sample times such as k·0.01 differ by an interval plus rounding; that must not cost a further step.
_ROUNDING = 1e-9

_OPTIONS = {"fastmath": ORDERED, "error_model": "numpy", "_nrt": False, "forceinline": True}


def advance(
    method: NamedTuple, kernel: Any, t: float, h: float, x: Array, scratch: Array, work: Array
) -> int:
    """Advance x (d,) from t by one step h [s]; the number of evaluations, or −status if it fails.

    Callable from compiled code only.
    """
    raise not_compiled("method", "advance", method)


def implements_advance(method_class: type) -> Callable[[Callable[..., int]], Callable[..., int]]:
    """Register the decorated function (method, kernel, t, h, x, scratch, work) -> int for `method_class`.

    It must not allocate: like right-hand sides it is compiled without reference counts.
    """

    def register(formula: Callable[..., int]) -> Callable[..., int]:
        @overload(advance, jit_options=_OPTIONS)
        def resolve(method, kernel, t, h, x, scratch, work):
            if isinstance(method, types.BaseNamedTuple) and method.instance_class is method_class:
                return formula
            return None

        return formula

    return register


@njit(error_model="numpy")
def steps_within(interval, longest_step):
    """The number of equal steps of at most `longest_step` that make an `interval`."""
    return max(1, int(np.ceil(interval / longest_step * (1.0 - _ROUNDING))))


@njit(error_model="numpy")
def all_finite(x):
    """Whether every value of x (d,) is finite."""
    total = 0.0
    for i in range(x.size):
        total += 0.0 * x[i]  # NaN as soon as one value is infinite or NaN
    return total == 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def run_fixed_step(method, kernel, t, x, longest_step, work):
    """Fill x (m, d) from its first row at times t (m,), in equal steps of `longest_step` [s] or less.

    Returns the rows filled, the time of the last finite state, evaluations, steps, and a status.
    """
    # Allocated here and with a constant width, rows are known not to overlap: twice as fast.
    d = states(method.constant, x[0])
    scratch = np.empty((method.rows, d))
    for s in range(method.rows):
        for i in range(d):
            scratch[s, i] = np.nan  # tells a method that carries something over that there is nothing yet
    state = np.empty(d)
    for i in range(d):
        state[i] = x[0, i]
    evaluations = 0
    steps = 0
    for row in range(1, t.size):
        begin = t[row - 1]
        interval = t[row] - begin
        count = steps_within(interval, longest_step)
        h = interval / count
        for n in range(count):
            calls = advance(method, kernel, begin + n * h, h, state, scratch, work)
            if calls < 0:
                return row, begin + n * h, evaluations, steps, -calls
            evaluations += calls
            if not all_finite(state):
                return row, begin + n * h, evaluations, steps, NOT_FINITE
            steps += 1
        for i in range(d):
            x[row, i] = state[i]
    return t.size, t[-1], evaluations, steps, COMPLETED


_RK4_STAGES = len(RK4.c)
_DOP853_STAGES = len(DOP853.method.c)


class RungeKutta4(NamedTuple):
    """The classical method of order 4, four evaluations a step."""

    constant: Dimension
    rows: int = _RK4_STAGES + 1


class RungeKutta8(NamedTuple):
    """DOP853's method of order 8, twelve evaluations a step."""

    constant: Dimension
    rows: int = _DOP853_STAGES + 1


@implements_advance(RungeKutta4)
def _advance_4(method, kernel, t, h, x, scratch, work):
    rhs(kernel, t, x, scratch[0], work)
    rk4_step(kernel, t, h, x, x, scratch, scratch[_RK4_STAGES], work, method.constant)
    return _RK4_STAGES


@implements_advance(RungeKutta8)
def _advance_8(method, kernel, t, h, x, scratch, work):
    rhs(kernel, t, x, scratch[0], work)
    dop853_step(kernel, t, h, x, x, scratch, scratch[_DOP853_STAGES], work, method.constant)
    return _DOP853_STAGES
