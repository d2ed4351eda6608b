"""Radau IIA of order 5: implicit, L-stable, step chosen by an embedded error estimate.

Collocation at three Radau nodes. The stage equations are solved by simplified Newton iteration, whose
linear system of 3 d unknowns falls apart into a real and a complex one of d by the eigenvectors of A⁻¹.
Source: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., Springer 1996,
section IV.8; the numbers of equations below are theirs.
"""

import numpy as np
from numba import njit

from flexsurr.simulation.adaptive_explicit import first_step, smallest_step
from flexsurr.simulation.dimension import ORDERED
from flexsurr.simulation.fixed_step import all_finite
from flexsurr.simulation.jacobian import jacobian
from flexsurr.simulation.linear_solvers import factorise, solve
from flexsurr.simulation.rhs import rhs
from flexsurr.simulation.trajectory import COMPLETED, NOT_FINITE, STEP_TOO_SMALL

_STAGES = 3
_C = np.array([(4 - np.sqrt(6)) / 10, (4 + np.sqrt(6)) / 10, 1.0])
_POWERS = np.arange(1, _STAGES + 1)
# The stages' increments z_i = Σ_k a_k c_i^k have the slopes h f_i = Σ_k k a_k c_i^(k−1): A⁻¹ maps z to h f.
_A_INVERSE = _POWERS * _C[:, None] ** (_POWERS - 1) @ np.linalg.inv(_C[:, None] ** _POWERS)
_EIGENVALUES, _VECTORS = np.linalg.eig(_A_INVERSE)
_REAL = int(np.argmin(abs(_EIGENVALUES.imag)))
_COMPLEX = int(np.argmax(_EIGENVALUES.imag))  # the third is its conjugate
_LEFT = np.linalg.inv(_VECTORS)
_MU_REAL = float(_EIGENVALUES[_REAL].real)
_MU_COMPLEX = complex(_EIGENVALUES[_COMPLEX])
_TO_REAL = np.ascontiguousarray(_LEFT[_REAL].real)
_TO_COMPLEX = np.ascontiguousarray(_LEFT[_COMPLEX])
_FROM_REAL = np.ascontiguousarray(_VECTORS[:, _REAL].real)
_FROM_COMPLEX = np.ascontiguousarray(2.0 * _VECTORS[:, _COMPLEX])

_ERROR = np.array([-13 - 7 * np.sqrt(6), -13 + 7 * np.sqrt(6), -1.0]) / 3  # (8.19)

_MOST_ITERATIONS = 7
_SAFETY = 0.9
_SHRINK = 0.2
_GROW = 8.0
_KEEP_BELOW = 1.2  # a step that would grow by less keeps its factors
_SLOW = 1e-3  # a faster contraction keeps its Jacobian
_EPSILON = float(np.finfo(np.float64).eps)


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)
def _weights(theta):
    """Values at θ of the polynomials that are 1 at one node, 0 at the others and at θ = 0."""
    u = theta - _C[0]
    v = theta - _C[1]
    w = theta - _C[2]
    return (
        theta * v * w / (_C[0] * (_C[0] - _C[1]) * (_C[0] - _C[2])),
        theta * u * w / (_C[1] * (_C[1] - _C[0]) * (_C[1] - _C[2])),
        theta * u * v / (_C[2] * (_C[2] - _C[0]) * (_C[2] - _C[1])),
    )


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)
def _extrapolate(z, ratio, guess):
    """Continue the last step's stages z (3, d) into a next one that is `ratio` times as long."""
    for s in range(_STAGES):
        first, second, third = _weights(1.0 + _C[s] * ratio)
        for i in range(z.shape[1]):
            guess[s, i] = first * z[0, i] + second * z[1, i] + (third - 1.0) * z[2, i]


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)
def _factorise(h, jac, real, real_pivots, complex_, complex_pivots):
    """Factorise μ/h I − J for both eigenvalues; False if one is singular."""
    d = jac.shape[0]
    for i in range(d):
        for j in range(d):
            real[i, j] = -jac[i, j]
            complex_[i, j] = -jac[i, j]
        real[i, i] += _MU_REAL / h
        complex_[i, i] += _MU_COMPLEX / h
    return factorise(real, real_pivots) and factorise(complex_, complex_pivots)


@njit(error_model="numpy", fastmath=ORDERED, _nrt=False)
def _newton(kernel, t, h, x, z, f, w, v, y, real, real_pivots, complex_, complex_pivots, rtol, atol, work):
    """Solve the stage equations for z (3, d) from the guess it holds.

    Returns convergence, iterations, and the last contraction rate. Stopping rule: (8.10), (8.11).
    """
    d = x.size
    tolerance = max(10.0 * _EPSILON / rtol, min(0.03, np.sqrt(rtol)))
    previous = 0.0
    rate = 1.0
    for iteration in range(1, _MOST_ITERATIONS + 1):
        for s in range(_STAGES):
            for i in range(d):
                y[i] = x[i] + z[s, i]
            rhs(kernel, t + _C[s] * h, y, f[s], work)
        for i in range(d):
            w[i] = 0.0
            v[i] = 0.0
            for s in range(_STAGES):
                w[i] += _TO_REAL[s] * (f[s, i] - _MU_REAL / h * z[s, i])
                v[i] += _TO_COMPLEX[s] * (f[s, i] - _MU_COMPLEX / h * z[s, i])
        solve(real, real_pivots, w)
        solve(complex_, complex_pivots, v)
        square = 0.0
        for i in range(d):
            scale = 1.0 / (atol + rtol * abs(x[i]))
            for s in range(_STAGES):
                change = _FROM_REAL[s] * w[i] + (_FROM_COMPLEX[s] * v[i]).real
                z[s, i] += change
                square += (scale * change) * (scale * change)
        size = np.sqrt(square / (_STAGES * d))
        if not np.isfinite(size):
            return False, iteration, rate
        if iteration > 1:
            rate = size / previous
            left = _MOST_ITERATIONS - iteration
            if rate >= 1.0 or rate**left / (1.0 - rate) * size > tolerance:
                return False, iteration, rate
        if size == 0.0 or (iteration > 1 and rate / (1.0 - rate) * size < tolerance):
            return True, iteration, rate
        previous = size
    return False, _MOST_ITERATIONS, rate


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)
def _estimate(h, x, new, z, slope, error, real, real_pivots, rtol, atol):
    """Norm of the error estimate, left in `error`: (8.19) with f at the beginning as `slope`, or (8.20)."""
    for i in range(x.size):
        total = slope[i]
        for s in range(_STAGES):
            total += _ERROR[s] / h * z[s, i]
        error[i] = total
    solve(real, real_pivots, error)
    square = 0.0
    for i in range(x.size):
        ratio = error[i] / (atol + rtol * max(abs(x[i]), abs(new[i])))
        square += ratio * ratio
    return np.sqrt(square / x.size)


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)
def _growth(error, h, last_error, last_h):
    """Ratio of the next step to this one, before safety; predictive, (8.25)."""
    if error == 0.0:
        return _GROW
    classic = error**-0.25
    if last_h == 0.0 or last_error == 0.0:
        return classic
    return classic * min(1.0, h / last_h * (last_error / error) ** 0.25)


@njit(error_model="numpy", fastmath=ORDERED, _nrt=False)
def _integrate(
    kernel, t, x, rtol, atol, work,
    jac, real, complex_, real_pivots, complex_pivots,
    z, guess, f, v, w, y, now, new, slope,
):  # fmt: skip
    """As `run_radau`, with workspaces; apart from it because reference counts in the loop cost time."""
    d = x.shape[1]
    for i in range(d):
        now[i] = x[0, i]
    time = t[0]
    end = t[-1]
    steps = 0
    row = 1
    rhs(kernel, time, now, slope, work)
    evaluations = 1
    if not all_finite(slope):
        return row, time, evaluations, steps, NOT_FINITE
    h = first_step(kernel, time, now, slope, end - time, 3, rtol, atol, y, w, work)
    evaluations += 1 + jacobian(kernel, time, now, slope, jac, work)
    fresh_jacobian = True
    factorised_h = 0.0
    last_h = 0.0
    last_error = 0.0
    rejected = False
    finite = True
    while row < t.size:
        if not h >= smallest_step(time):
            return row, time, evaluations, steps, STEP_TOO_SMALL if finite else NOT_FINITE
        last = time + 1.0001 * h >= end
        if last:
            h = end - time
        if h != factorised_h:
            finite = _factorise(h, jac, real, real_pivots, complex_, complex_pivots)
            if not finite:
                h *= 0.5
                continue
            factorised_h = h
        if last_h > 0.0:
            _extrapolate(z, h / last_h, guess)
        else:
            for s in range(_STAGES):
                for i in range(d):
                    guess[s, i] = 0.0
        converged, iterations, rate = _newton(
            kernel, time, h, now, guess, f, w, v, y,
            real, real_pivots, complex_, complex_pivots, rtol, atol, work,
        )  # fmt: skip
        evaluations += _STAGES * iterations
        if not converged:
            finite = all_finite(f[0]) and all_finite(f[1]) and all_finite(f[2])
            if fresh_jacobian:
                h *= 0.5
            else:
                evaluations += jacobian(kernel, time, now, slope, jac, work)
                fresh_jacobian = True
                factorised_h = 0.0
            continue
        for i in range(d):
            new[i] = now[i] + guess[_STAGES - 1, i]
        error = _estimate(h, now, new, guess, slope, w, real, real_pivots, rtol, atol)
        if error >= 1.0 and (rejected or steps == 0):
            for i in range(d):
                y[i] = now[i] + w[i]
            rhs(kernel, time, y, f[0], work)
            evaluations += 1
            error = _estimate(h, now, new, guess, f[0], w, real, real_pivots, rtol, atol)
        safety = _SAFETY * (2 * _MOST_ITERATIONS + 1) / (2 * _MOST_ITERATIONS + iterations)
        if not error < 1.0:
            finite = error == error
            h *= max(_SHRINK, safety * error**-0.25) if finite else _SHRINK
            rejected = True
            continue
        rhs(kernel, time + h, new, f[0], work)
        evaluations += 1
        finite = all_finite(f[0])
        if not finite:
            h *= _SHRINK
            rejected = True
            continue
        factor = min(1.0 if rejected else _GROW, safety * _growth(error, h, last_error, last_h))
        z, guess = guess, z
        while row < t.size and (last or t[row] <= time + h):
            first, second, third = _weights((t[row] - time) / h)
            for i in range(d):
                x[row, i] = now[i] + first * z[0, i] + second * z[1, i] + third * z[2, i]
            row += 1
        for i in range(d):
            now[i] = new[i]
            slope[i] = f[0, i]
        time = end if last else time + h
        steps += 1
        last_h = h
        last_error = max(error, 1e-2)
        rejected = False
        fresh_jacobian = False
        if iterations > 2 and rate > _SLOW:
            evaluations += jacobian(kernel, time, now, slope, jac, work)
            fresh_jacobian = True
            factorised_h = 0.0
            h *= max(_SHRINK, factor)
        elif factor < 1.0 or factor >= _KEEP_BELOW:
            h *= max(_SHRINK, factor)
    return row, time, evaluations, steps, COMPLETED


@njit(cache=True, nogil=True, error_model="numpy", fastmath=ORDERED)
def run_radau(kernel, t, x, rtol, atol, work):
    """Fill x (m, d) from its first row at times t (m,), to relative and absolute tolerance a step.

    Returns the rows filled, the time of the last accepted state, evaluations, accepted steps, a status.
    """
    d = x.shape[1]
    jac = np.empty((d, d))
    real = np.empty((d, d))
    complex_ = np.empty((d, d), dtype=np.complex128)
    real_pivots = np.empty(d, dtype=np.int64)
    complex_pivots = np.empty(d, dtype=np.int64)
    z = np.zeros((_STAGES, d))  # of the last accepted step
    guess = np.zeros((_STAGES, d))  # of the step tried
    f = np.empty((_STAGES, d))
    v = np.empty(d, dtype=np.complex128)
    w = np.empty(d)
    y = np.empty(d)
    now = np.empty(d)
    new = np.empty(d)
    slope = np.empty(d)
    return _integrate(
        kernel, t, x, rtol, atol, work,
        jac, real, complex_, real_pivots, complex_pivots,
        z, guess, f, v, w, y, now, new, slope,
    )  # fmt: skip
