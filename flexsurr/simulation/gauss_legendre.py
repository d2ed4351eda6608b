"""Gauss–Legendre collocation of order 4 and 6: implicit, symplectic, time-reversible.

The stages are solved to rounding by fixed-point iteration from an extrapolation of the last step's, since
a remainder above rounding shows as a drift of the energy; sums of increments are compensated for the same
reason. Iteration converges while h is shorter than the fastest time scale: these methods are for energy
over long times, not for stiffness. Source: E. Hairer, C. Lubich, G. Wanner, *Geometric Numerical
Integration*, 2nd ed., Springer 2006, sections II.1.3 and VIII.6.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from flexsurr.simulation.collocation import collocation_matrix, lagrange
from flexsurr.simulation.dimension import Dimension, states
from flexsurr.simulation.fixed_step import implements_advance
from flexsurr.simulation.outcome import NOT_CONVERGED, NOT_FINITE
from flexsurr.simulation.rhs import rhs

_MOST_SWEEPS = 60
# Changes of the stages relative to the state: below the first nothing is left to gain, below the second a
# change that no longer shrinks is rounding.
_NEGLIGIBLE = 1e-17
_ROUNDING = 1e-13


def _coefficients(stages: int) -> tuple[np.ndarray, ...]:
    """Nodes c, matrix A and weights b of the method, and the extrapolation of its stages by one step."""
    c = 0.5 + 0.5 * np.polynomial.legendre.leggauss(stages)[0]
    return c, collocation_matrix(c, c), collocation_matrix(c, np.ones(1))[0], lagrange(c, 1.0 + c)


_C_4, _A_4, _B_4, _EXTRAPOLATION_4 = _coefficients(2)
_C_6, _A_6, _B_6, _EXTRAPOLATION_6 = _coefficients(3)


class GaussLegendre4(NamedTuple):
    """Two stages."""

    constant: Dimension
    rows: int = 5


class GaussLegendre6(NamedTuple):
    """Three stages."""

    constant: Dimension
    rows: int = 7


@implements_advance(GaussLegendre4)
def _advance_4(method, kernel, t, h, x, scratch, work):
    return _step(kernel, t, h, x, scratch, work, method.constant, _C_4, _A_4, _B_4, _EXTRAPOLATION_4)


@implements_advance(GaussLegendre6)
def _advance_6(method, kernel, t, h, x, scratch, work):
    return _step(kernel, t, h, x, scratch, work, method.constant, _C_6, _A_6, _B_6, _EXTRAPOLATION_6)


@njit(error_model="numpy")
def _step(kernel, t, h, x, k, work, constant, c, a, b, extrapolation):
    """As `advance`.

    The rows of k are the stages, as many of scratch, and what rounding took from the state. On the first
    step they are NaN.
    """
    stages = c.size
    d = states(constant, x)
    if k[0, 0] == k[0, 0]:
        evaluations = 0
        _extrapolate(k, d, extrapolation)
    else:
        evaluations = 1
        rhs(kernel, t, x, k[0], work)
        for i in range(d):
            k[2 * stages, i] = 0.0
            for s in range(1, stages):
                k[s, i] = k[0, i]
    previous = np.inf
    for _ in range(_MOST_SWEEPS):
        change = _sweep(kernel, t, h, x, k, work, d, c, a)
        evaluations += stages
        if change != change:
            return -NOT_CONVERGED if np.isfinite(previous) else -NOT_FINITE
        if _has_converged(change, previous):
            _add_increment(x, h, k, d, b)
            return evaluations
        previous = change
    return -NOT_CONVERGED


@njit(error_model="numpy")
def _extrapolate(k, d, extrapolation):
    """Continue the last step's stages into the next one."""
    stages = extrapolation.shape[0]
    for i in range(d):
        for s in range(stages):
            value = 0.0
            for j in range(stages):
                value += extrapolation[s, j] * k[j, i]
            k[stages + s, i] = value
        for s in range(stages):
            k[s, i] = k[stages + s, i]


@njit(error_model="numpy")
def _sweep(kernel, t, h, x, k, work, d, c, a):
    """One iteration over the stages, each from the newest others; the largest relative change."""
    stages = c.size
    y = k[stages]
    new = k[stages + 1]
    largest = 0.0
    for s in range(stages):
        for i in range(d):
            total = 0.0
            for j in range(stages):
                total += a[s, j] * k[j, i]
            y[i] = x[i] + h * total
        rhs(kernel, t + c[s] * h, y, new, work)
        for i in range(d):
            change = h * abs(new[i] - k[s, i])
            scale = abs(x[i]) + h * abs(new[i])
            if change > largest * scale:
                largest = change / scale
            elif change != change:
                return np.nan
            k[s, i] = new[i]
    return largest


@njit(error_model="numpy")
def _has_converged(change, previous):
    """Whether the stages are exact to rounding, from the last two changes of the iteration."""
    if change >= previous or not np.isfinite(previous):
        return change < _ROUNDING
    rate = change / previous
    return change * rate <= _NEGLIGIBLE * (1.0 - rate)


@njit(error_model="numpy")
def _add_increment(x, h, k, d, b):
    """Add h Σ b_s k_s to x, keeping what rounding loses for the next time (Kahan's summation)."""
    stages = b.size
    lost = k[2 * stages]
    for i in range(d):
        total = 0.0
        for s in range(stages):
            total += b[s] * k[s, i]
        total = h * total + lost[i]
        new = x[i] + total
        lost[i] = (x[i] - new) + total
        x[i] = new
