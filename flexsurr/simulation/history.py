"""Histories in time: the factor of a load at every instant, in Python and compiled.

A history acts from its start until just before its end. At a jump it has the value of the interval that
begins there; `simulate` keeps the stages of the interval that ends there short of it by a few
floating-point numbers.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.config.history import Constant, OneMinusCosine, Power, Ramp, Sine, Table
from flexsurr.simulation.rhs import FLOATING_POINT, Array

History = Constant | Ramp | Sine | OneMinusCosine | Power | Table

_CONSTANT, _RAMP, _SINE, _ONE_MINUS_COSINE, _POWER, _TABLE = range(6)


class HistoriesKernel(NamedTuple):
    """Histories for compiled code. One class for all kinds and any number: it is compiled once."""

    kinds: NDArray[np.int64]  # (k,)
    starts: Array  # (k,) [s]
    ends: Array  # (k,) [s], may be infinite
    scales: Array  # (k,) sine: ω [rad/s]; power: reference time [s]; ramp and bump: how long they last [s]
    numbers: Array  # (k,) sine: phase [rad]; power: exponent
    rows: NDArray[np.int64]  # (k + 1,) where the rows of each one's table begin
    times: Array  # (rows,) of all tables [s]
    factors: Array  # (rows,)


def factor(history: History, t: float) -> float:
    """The factor at time t [s]; 0 outside the interval."""
    if not start_s(history) <= t < end_s(history):
        return 0.0
    match history:
        case Ramp(rise_s=rise):
            return min((t - history.start_s) / rise, 1.0)
        case Sine(frequency_rad_s=omega, phase_rad=phase):
            return math.sin(omega * t + phase)
        case OneMinusCosine(duration_s=duration):
            return 0.5 * (1.0 - math.cos(2.0 * math.pi * (t - history.start_s) / duration))
        case Power(reference_s=reference, exponent=exponent):
            return float((t / reference) ** exponent)
        case Table(times_s=times, factors=factors):
            return float(np.interp(t, times, factors))
    return 1.0


def start_s(history: History) -> float:
    """When it begins [s]: a table not before its first time."""
    return max(history.start_s, history.times_s[0]) if isinstance(history, Table) else history.start_s


def end_s(history: History) -> float:
    """When it ends [s]; infinite where it does not."""
    own = math.inf
    if isinstance(history, OneMinusCosine):
        own = history.start_s + history.duration_s
    elif isinstance(history, Table):
        own = history.times_s[-1]
    return own if history.end_s is None else min(own, history.end_s)


def breakpoints(history: History) -> tuple[float, ...]:
    """Times [s] at which the factor, or its rate, may jump; of a table only where it begins and ends."""
    begins, ends = start_s(history), end_s(history)
    within = [history.start_s + history.rise_s] if isinstance(history, Ramp) else []
    return tuple(time for time in (begins, *(t for t in within if t < ends), ends) if math.isfinite(time))


def histories_kernel(histories: Sequence[History]) -> HistoriesKernel:
    """What `history_factor` takes."""
    tables = [history if isinstance(history, Table) else None for history in histories]
    times, factors = (
        np.array(
            [value for table in tables if table is not None for value in getattr(table, of)], dtype=float
        )
        for of in ("times_s", "factors")
    )
    kinds, scales, numbers = zip(*map(_constants, histories), strict=True)
    return HistoriesKernel(
        kinds=np.array(kinds, dtype=np.int64),
        starts=np.array([start_s(history) for history in histories], dtype=float),
        ends=np.array([end_s(history) for history in histories], dtype=float),
        scales=np.array(scales, dtype=float),
        numbers=np.array(numbers, dtype=float),
        rows=np.cumsum(
            [0, *(0 if table is None else len(table.times_s) for table in tables)], dtype=np.int64
        ),
        times=times,
        factors=factors,
    )


def _constants(history: History) -> tuple[int, float, float]:
    """Kind, scale and number of a history in `HistoriesKernel`."""
    match history:
        case Ramp():
            return _RAMP, history.rise_s, 0.0
        case Sine():
            return _SINE, history.frequency_rad_s, history.phase_rad
        case OneMinusCosine():
            return _ONE_MINUS_COSINE, history.duration_s, 0.0
        case Power():
            return _POWER, history.reference_s, float(history.exponent)
        case Table():
            return _TABLE, 1.0, 0.0
    return _CONSTANT, 1.0, 0.0


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def history_factor(kernel, k, t):
    """`factor` of history `k` in `kernel` at t [s]."""
    if not kernel.starts[k] <= t < kernel.ends[k]:
        return 0.0
    kind, scale = kernel.kinds[k], kernel.scales[k]
    if kind == _SINE:
        return math.sin(scale * t + kernel.numbers[k])
    if kind == _POWER:
        return (t / scale) ** kernel.numbers[k]
    if kind == _RAMP:
        return min((t - kernel.starts[k]) / scale, 1.0)
    if kind == _ONE_MINUS_COSINE:
        return 0.5 * (1.0 - math.cos(2.0 * math.pi * (t - kernel.starts[k]) / scale))
    if kind == _TABLE:
        low, high = kernel.rows[k], kernel.rows[k + 1] - 1
        while high - low > 1:
            middle = (low + high) // 2
            if kernel.times[middle] <= t:
                low = middle
            else:
                high = middle
        part = (t - kernel.times[low]) / (kernel.times[high] - kernel.times[low])
        return kernel.factors[low] + part * (kernel.factors[high] - kernel.factors[low])
    return 1.0
