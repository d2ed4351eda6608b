"""Histories in time: the factor of a load at every instant, its slope and integral, in Python and compiled.

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

from flexsurr.config.history import Constant, OneMinusCosine, Power, Ramp, Sine, SmoothRamp, Table
from flexsurr.simulation.rhs import FLOATING_POINT, Array

History = Constant | Ramp | SmoothRamp | Sine | OneMinusCosine | Power | Table

_CONSTANT, _RAMP, _SINE, _ONE_MINUS_COSINE, _POWER, _TABLE, _SMOOTH_RAMP = range(7)
_TURN = 2.0 * math.pi


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
    areas: Array  # (rows,) integral of the factor from the start of its history [s]


def factor(history: History, t: float) -> float:
    """The factor at time t [s]; 0 outside the interval."""
    if not start_s(history) <= t < end_s(history):
        return 0.0
    match history:
        case Ramp(rise_s=rise):
            return min((t - history.start_s) / rise, 1.0)
        case SmoothRamp(rise_s=rise):
            part = min((t - history.start_s) / rise, 1.0)
            return part - math.sin(_TURN * part) / _TURN
        case Sine(frequency_rad_s=omega, phase_rad=phase):
            return math.sin(omega * t + phase)
        case OneMinusCosine(duration_s=duration):
            return 0.5 * (1.0 - math.cos(_TURN * (t - history.start_s) / duration))
        case Power(reference_s=reference, exponent=exponent):
            return float((t / reference) ** exponent)
        case Table(times_s=times, factors=factors):
            return float(np.interp(t, times, factors))
    return 1.0


def slope(history: History, t: float) -> float:
    """The rate of the factor at time t [1/s]: from the right where it jumps, 0 outside the interval."""
    if not start_s(history) <= t < end_s(history):
        return 0.0
    match history:
        case Ramp(rise_s=rise):
            return 1.0 / rise if t - history.start_s < rise else 0.0
        case SmoothRamp(rise_s=rise):
            return (1.0 - math.cos(_TURN * min((t - history.start_s) / rise, 1.0))) / rise
        case Sine(frequency_rad_s=omega, phase_rad=phase):
            return omega * math.cos(omega * t + phase)
        case OneMinusCosine(duration_s=duration):
            return 0.5 * _TURN / duration * math.sin(_TURN * (t - history.start_s) / duration)
        case Power(reference_s=reference, exponent=exponent):
            return float(exponent / reference * (t / reference) ** (exponent - 1))
        case Table(times_s=times, factors=factors):
            low = min(int(np.searchsorted(times, t, side="right")), len(times) - 1) - 1
            return (factors[low + 1] - factors[low]) / (times[low + 1] - times[low])
    return 0.0


def integral(history: History, t: float) -> float:
    """The integral of the factor up to time t [s]."""
    begins = start_s(history)
    until = min(t, end_s(history))
    if until <= begins:
        return 0.0
    past = until - begins
    match history:
        case Ramp(rise_s=rise):
            return 0.5 * past**2 / rise if past < rise else past - 0.5 * rise
        case SmoothRamp(rise_s=rise):
            if past >= rise:
                return past - 0.5 * rise
            return 0.5 * past**2 / rise + rise / _TURN**2 * (math.cos(_TURN * past / rise) - 1.0)
        case Sine(frequency_rad_s=omega, phase_rad=phase):
            return (math.cos(omega * begins + phase) - math.cos(omega * until + phase)) / omega
        case OneMinusCosine(duration_s=duration):
            return 0.5 * (past - duration / _TURN * math.sin(_TURN * past / duration))
        case Power(reference_s=reference, exponent=exponent):
            powers = (until / reference) ** (exponent + 1) - (begins / reference) ** (exponent + 1)
            return float(reference * powers / (exponent + 1))
        case Table():
            return _area(history, begins, until)
    return past


def _area(table: Table, begins: float, until: float) -> float:
    """The integral of a table's straight lines between two times [s]."""
    knots = [begins, *(time for time in table.times_s if begins < time < until), until]
    return float(np.trapezoid(np.interp(knots, table.times_s, table.factors), knots))


def _areas(table: Table) -> Array:
    """The integral of the factor from the start of the table's history to each of its times [s]."""
    times, factors = np.array(table.times_s), np.array(table.factors)
    areas = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(times) * (factors[1:] + factors[:-1]))])
    return np.asarray(areas - _area(table, table.times_s[0], start_s(table)))


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
    within = [history.start_s + history.rise_s] if isinstance(history, Ramp | SmoothRamp) else []
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
        areas=np.concatenate([np.empty(0), *(_areas(table) for table in tables if table is not None)]),
    )


def _constants(history: History) -> tuple[int, float, float]:
    """Kind, scale and number of a history in `HistoriesKernel`."""
    match history:
        case Ramp():
            return _RAMP, history.rise_s, 0.0
        case SmoothRamp():
            return _SMOOTH_RAMP, history.rise_s, 0.0
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
    if kind == _SMOOTH_RAMP:
        part = min((t - kernel.starts[k]) / scale, 1.0)
        return part - math.sin(_TURN * part) / _TURN
    if kind == _ONE_MINUS_COSINE:
        return 0.5 * (1.0 - math.cos(_TURN * (t - kernel.starts[k]) / scale))
    if kind == _TABLE:
        low = _row(kernel, k, t)
        return kernel.factors[low] + (t - kernel.times[low]) * _row_slope(kernel, low)
    return 1.0


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def history_slope(kernel, k, t):
    """`slope` of history `k` in `kernel` at t [s]."""
    if not kernel.starts[k] <= t < kernel.ends[k]:
        return 0.0
    kind, scale, past = kernel.kinds[k], kernel.scales[k], t - kernel.starts[k]
    if kind == _SINE:
        return scale * math.cos(scale * t + kernel.numbers[k])
    if kind == _POWER:
        return kernel.numbers[k] / scale * (t / scale) ** (kernel.numbers[k] - 1.0)
    if kind == _RAMP:
        return 1.0 / scale if past < scale else 0.0
    if kind == _SMOOTH_RAMP:
        return (1.0 - math.cos(_TURN * min(past / scale, 1.0))) / scale
    if kind == _ONE_MINUS_COSINE:
        return 0.5 * _TURN / scale * math.sin(_TURN * past / scale)
    if kind == _TABLE:
        return _row_slope(kernel, _row(kernel, k, t))
    return 0.0


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def history_integral(kernel, k, t):
    """`integral` of history `k` in `kernel` up to t [s]."""
    begins, until = kernel.starts[k], min(t, kernel.ends[k])
    if until <= begins:
        return 0.0
    kind, scale, past = kernel.kinds[k], kernel.scales[k], until - begins
    if kind == _SINE:
        phase = kernel.numbers[k]
        return (math.cos(scale * begins + phase) - math.cos(scale * until + phase)) / scale
    if kind == _POWER:
        exponent = kernel.numbers[k] + 1.0
        return scale * ((until / scale) ** exponent - (begins / scale) ** exponent) / exponent
    if kind == _RAMP:
        return 0.5 * past * past / scale if past < scale else past - 0.5 * scale
    if kind == _SMOOTH_RAMP:
        if past >= scale:
            return past - 0.5 * scale
        return 0.5 * past * past / scale + scale / _TURN**2 * (math.cos(_TURN * past / scale) - 1.0)
    if kind == _ONE_MINUS_COSINE:
        return 0.5 * (past - scale / _TURN * math.sin(_TURN * past / scale))
    if kind == _TABLE:
        low = _row(kernel, k, until)
        step = until - kernel.times[low]
        return kernel.areas[low] + step * (kernel.factors[low] + 0.5 * step * _row_slope(kernel, low))
    return past


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def _row(kernel, k, t):
    """The row of table `k` from which a straight line leads past t [s]."""
    low, high = kernel.rows[k], kernel.rows[k + 1] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if kernel.times[middle] <= t:
            low = middle
        else:
            high = middle
    return low


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def _row_slope(kernel, row):
    """The slope of the straight line from a table's row to the next [1/s]."""
    rise = kernel.factors[row + 1] - kernel.factors[row]
    return rise / (kernel.times[row + 1] - kernel.times[row])
