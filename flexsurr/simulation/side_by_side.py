"""Many trajectories side by side, in lockstep: structure of arrays, so that the compiler vectorises.

A block of `LANES` trajectories is one system of equations: state i of trajectory b lies at i · LANES + b. The
explicit methods at a fixed step take it as they take any other; only what ends a trajectory is looked for
in each by itself. Which trajectories share a block changes no bit of their results: no value of one enters
another's.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from flexsurr.config.study import Integrator, IntegratorMethod
from flexsurr.kernel_cache import not_compiled
from flexsurr.simulation.dimension import LANES, LARGEST_CONSTANT, SideBySide, dimension, states
from flexsurr.simulation.fixed_step import RungeKutta4, RungeKutta8, advance, steps_within
from flexsurr.simulation.rhs import FLOATING_POINT, Array, Model, implements_rhs, registered
from flexsurr.simulation.trajectory import COMPLETED, NOT_FINITE, Outcome, from_compiled

_METHODS: dict[IntegratorMethod, Callable[[Any], NamedTuple]] = {
    "rk4": RungeKutta4,
    "dop853_fixed": RungeKutta8,
}

_rows: dict[type, int] = {}


class Block(NamedTuple):
    """The equations of `kernel` for a block of trajectories."""

    kernel: Any


def rhs_of_block(kernel: Any, t: float, x: Array, dx: Array, work: Array) -> None:
    """`rhs` for a block of trajectories, all (d · LANES,); from compiled code only."""
    raise not_compiled("right-hand side of a block", "rhs_of_block", kernel)


def implements_rhs_of_block(
    kernel_class: type, rows: int = 0
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Register the decorated function (kernel, t, x, dx, work) -> None as `rhs_of_block` of `kernel_class`.

    `work` has `rows` of LANES values. An innermost loop over trajectories, that reads no coefficient from
    an array, is vectorised; so loop over terms or neurons outside, and keep sums in `dx`.
    """
    _rows[kernel_class] = rows
    return registered(rhs_of_block, kernel_class)


@implements_rhs(Block, inline=False)
def _block(kernel, t, x, dx, work):
    rhs_of_block(kernel.kernel, t, x, dx, work)


def takes(model: Model, integrator: Integrator) -> bool:
    """Whether `integrator` can step trajectories of `model` side by side."""
    return (
        integrator.method in _METHODS
        and type(getattr(model, "kernel", None)) in _rows
        and len(model.state_names) <= LARGEST_CONSTANT
        and not model.breakpoints
    )


def run_block(model: Any, integrator: Integrator, t: Array, x0: Array) -> tuple[Array, list[Outcome]]:
    """Trajectories from `x0` (k, d), k ≤ LANES, at times `t` (m,): states (k, m, d), and how each ended.

    What a trajectory that fails does not reach is not a number.
    """
    count, d = x0.shape
    x = np.zeros((t.size, d, LANES))
    x[0, :, :count] = x0.T
    x[0, :, count:] = x0[-1][:, None]  # what fills the block does as its last trajectory
    method = _METHODS[integrator.method](SideBySide(dimension(d)))
    work = aligned(LANES * _rows[type(model.kernel)])
    rows = np.full(LANES, t.size)
    end_s = np.full(LANES, t[-1])
    evaluations, steps = run_side_by_side(
        method, Block(model.kernel), t, x.reshape(t.size, -1), integrator.step_s, work, rows, end_s
    )
    outcomes = []
    for lane in range(count):
        status = COMPLETED if rows[lane] == t.size else NOT_FINITE
        x[rows[lane] :, :, lane] = np.nan
        outcomes.append(from_compiled(int(rows[lane]), float(end_s[lane]), evaluations, steps, status))
    return np.ascontiguousarray(x[:, :, :count].transpose(2, 0, 1)), outcomes


_LINE = 64
"""Bytes of a line of the cache, and of the longest vectors."""


@njit(cache=True, error_model="numpy")
def aligned(n):
    """(n,) numbers from the start of a line on: a vector that lies across two lines is fetched twice."""
    room = np.empty(n + _LINE // 8)
    first = (-(room.ctypes.data // 8)) % (_LINE // 8)
    return room[first : first + n]


@njit(error_model="numpy", fastmath=FLOATING_POINT)
def _none_lost(x):
    """Whether every value of x is finite; in any order, which `all_finite` does not allow."""
    total = 0.0
    for i in range(x.size):
        total += 0.0 * x[i]
    return total == 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def run_side_by_side(method, kernel, t, x, longest_step, work, rows, end_s):
    """As `run_fixed_step` for a block: fill x (m, d · LANES) from its first row at times t (m,).

    `rows` and `end_s` (LANES,) are set for each trajectory that leaves the finite numbers, to the rows
    filled and the time of its last finite state. Returns evaluations and steps of each trajectory.
    """
    # a constant width, as in `run_fixed_step`; in one piece, rows and state are seen not to overlap
    d = states(method.constant, x[0])
    room = aligned((method.rows + 1) * d)
    scratch = room[: method.rows * d].reshape((method.rows, d))
    state = room[method.rows * d :]
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
            evaluations += advance(method, kernel, begin + n * h, h, state, scratch, work)
            steps += 1
            if not _none_lost(state):
                for b in range(LANES):
                    total = 0.0
                    for i in range(b, d, LANES):
                        total += 0.0 * state[i]
                    if total != 0.0:
                        if rows[b] == t.size:
                            rows[b] = row
                            end_s[b] = begin + n * h
                        for i in range(b, d, LANES):
                            state[i] = 0.0  # goes on from the origin, unseen, and costs no further look
        for i in range(d):
            x[row, i] = state[i]
    return evaluations, steps
