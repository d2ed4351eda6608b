"""Gauss–Legendre collocation of order 4 and 6: implicit, symplectic, time-reversible.

The stages are solved to rounding by fixed-point iteration from an extrapolation of the last step's, since
a remainder above rounding shows as a drift of the energy; sums of increments are compensated for the same
reason. Iteration converges while h is shorter than the fastest time scale: these methods are for energy
over long times, not for stiffness. Source: E. Hairer, C. Lubich, G. Wanner, *Geometric Numerical
Integration*, 2nd ed., Springer 2006, sections II.1.3 and VIII.6.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit

from flexsurr.simulation.dimension import Dimension
from flexsurr.simulation.fixed_step import implements_advance
from flexsurr.simulation.rhs import rhs
from flexsurr.simulation.tableaus import GAUSS_LEGENDRE_4, GAUSS_LEGENDRE_6
from flexsurr.simulation.trajectory import NOT_CONVERGED, NOT_FINITE
from flexsurr.simulation.unrolled import (
    gauss_legendre_4_extrapolate,
    gauss_legendre_4_increment,
    gauss_legendre_4_sweep,
    gauss_legendre_6_extrapolate,
    gauss_legendre_6_increment,
    gauss_legendre_6_sweep,
)

_MOST_SWEEPS = 60
_GOES_ON, _CONVERGED = range(2)

# Changes of the stages relative to the state: below the first nothing is left to gain, below the second a
# change that no longer shrinks is rounding.
_NEGLIGIBLE = 1e-17
_ROUNDING = 1e-13
_LARGEST = 1e3  # a change that grows beyond this will not come back

_STAGES_4 = len(GAUSS_LEGENDRE_4.c)
_STAGES_6 = len(GAUSS_LEGENDRE_6.c)
_FURTHER_ROWS = 3  # after the stages: what rounding took from the state, and scratch of a sweep (2)


class GaussLegendre4(NamedTuple):
    """Two stages."""

    constant: Dimension
    rows: int = _STAGES_4 + _FURTHER_ROWS


class GaussLegendre6(NamedTuple):
    """Three stages."""

    constant: Dimension
    rows: int = _STAGES_6 + _FURTHER_ROWS


def _collocation(
    stages: int, extrapolate: Callable[..., None], sweep: Callable[..., float], increment: Callable[..., None]
) -> Callable[..., int]:
    """The formula of a method, from the unrolled code of its tableau."""

    def formula(method, kernel, t, h, x, scratch, work):
        constant = method.constant
        lost = scratch[stages]
        y = scratch[stages + 1]
        new = scratch[stages + 2]
        evaluations = 0
        if scratch[0, 0] == scratch[0, 0]:
            extrapolate(x, scratch, constant)
        else:
            evaluations = _begin(kernel, t, x, scratch, work, stages)
        previous = np.inf
        for _ in range(_MOST_SWEEPS):
            change = sweep(kernel, t, h, x, scratch, y, new, work, constant)
            evaluations += stages
            verdict = _judge(change, previous)
            if verdict == _CONVERGED:
                increment(h, x, scratch, lost, constant)
                return evaluations
            if verdict < 0:
                return verdict
            previous = change
        return -NOT_CONVERGED

    return formula


@njit(error_model="numpy", _nrt=False)
def _begin(kernel, t, x, k, work, stages):
    """On the first step, which finds NaN in its scratch, start every stage from f(t, x)."""
    rhs(kernel, t, x, k[0], work)
    for i in range(x.size):
        for s in range(1, stages):
            k[s, i] = k[0, i]
        k[stages, i] = 0.0
    return 1


@njit(error_model="numpy", _nrt=False)
def _judge(change, previous):
    """What two successive changes say of the iteration: converged to rounding, going on, or −status."""
    if change != change:
        return -NOT_CONVERGED if np.isfinite(previous) else -NOT_FINITE
    if change >= previous:
        return _CONVERGED if change < _ROUNDING else (-NOT_CONVERGED if change > _LARGEST else _GOES_ON)
    # what is left: the change times the rate of convergence over one minus it
    if np.isfinite(previous) and change * change <= _NEGLIGIBLE * (previous - change):
        return _CONVERGED
    return _GOES_ON


implements_advance(GaussLegendre4)(
    _collocation(_STAGES_4, gauss_legendre_4_extrapolate, gauss_legendre_4_sweep, gauss_legendre_4_increment)
)
implements_advance(GaussLegendre6)(
    _collocation(_STAGES_6, gauss_legendre_6_extrapolate, gauss_legendre_6_sweep, gauss_legendre_6_increment)
)
