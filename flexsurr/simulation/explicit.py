"""Explicit Runge–Kutta methods at a fixed step: the classical one of order 4, and DOP853's of order 8."""

from typing import NamedTuple

from flexsurr.simulation.dimension import Dimension
from flexsurr.simulation.fixed_step import implements_advance
from flexsurr.simulation.rhs import rhs
from flexsurr.simulation.tableaus import DOP853, RK4
from flexsurr.simulation.unrolled import dop853_step, rk4_step

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
