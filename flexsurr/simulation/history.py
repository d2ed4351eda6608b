"""Histories in time: the factor of a load at every instant, in Python and compiled.

A history acts from its start until just before its end. At a jump it has the value of the interval that
begins there; `simulate` keeps the stages of the interval that ends there short of it by a few
floating-point numbers.
"""

import math
from typing import NamedTuple

from numba import njit

from flexsurr.config.load import Constant, Power, Sine
from flexsurr.simulation.rhs import FLOATING_POINT

History = Constant | Sine | Power

_CONSTANT, _SINE, _POWER = range(3)


class HistoryKernel(NamedTuple):
    """A history for compiled code. One class for all kinds: a kernel that holds it is compiled once."""

    kind: int
    start: float  # [s]
    end: float  # [s], may be infinite
    scale: float  # sine: ω [rad/s]; power: reference time [s]
    number: float  # sine: phase [rad]; power: exponent


def factor(history: History, t: float) -> float:
    """The factor at time t [s]; 0 outside the interval."""
    if not history.start_s <= t < end_s(history):
        return 0.0
    if isinstance(history, Sine):
        return math.sin(history.frequency_rad_s * t + history.phase_rad)
    if isinstance(history, Power):
        return float((t / history.reference_s) ** history.exponent)
    return 1.0


def end_s(history: History) -> float:
    """When it ends [s]; infinite where it does not."""
    return math.inf if history.end_s is None else history.end_s


def breakpoints(history: History) -> tuple[float, ...]:
    """Times [s] at which the factor may jump."""
    return tuple(time for time in (history.start_s, end_s(history)) if math.isfinite(time))


def history_kernel(history: History) -> HistoryKernel:
    """What `history_factor` takes."""
    kind, scale, number = _CONSTANT, 1.0, 0.0
    if isinstance(history, Sine):
        kind, scale, number = _SINE, history.frequency_rad_s, history.phase_rad
    elif isinstance(history, Power):
        kind, scale, number = _POWER, history.reference_s, float(history.exponent)
    return HistoryKernel(kind, float(history.start_s), end_s(history), float(scale), float(number))


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def history_factor(kernel, t):
    """`factor` of the history in `kernel` at t [s]."""
    if not kernel.start <= t < kernel.end:
        return 0.0
    if kernel.kind == _SINE:
        return math.sin(kernel.scale * t + kernel.number)
    if kernel.kind == _POWER:
        return (t / kernel.scale) ** kernel.number
    return 1.0
