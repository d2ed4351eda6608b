"""DOP853: order 8, step chosen by an embedded error estimate, dense output of order 7.

Before it stands what every method that chooses its steps takes: the scaled norm, the first step and the
smallest.

Source: E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed.,
Springer 1993, sections II.4 (step control), II.5 (method), II.6 (dense output).
"""

import numpy as np
from numba import njit

from flexsurr.simulation.dimension import ORDERED, states
from flexsurr.simulation.fixed_step import all_finite
from flexsurr.simulation.rhs import rhs
from flexsurr.simulation.tableaus import DOP853
from flexsurr.simulation.trajectory import COMPLETED, NOT_FINITE, STEP_TOO_SMALL
from flexsurr.simulation.unrolled import dop853_dense, dop853_error, dop853_step

_EPSILON = float(np.finfo(np.float64).eps)


@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)
def scaled_norm(v, x, rtol, atol):
    """Root mean square of v_i / (atol + rtol |x_i|)."""
    total = 0.0
    for i in range(v.size):
        ratio = v[i] / (atol + rtol * abs(x[i]))
        total += ratio * ratio
    return np.sqrt(total / v.size)


@njit(error_model="numpy", fastmath=ORDERED, _nrt=False)
def first_step(kernel, t, x, dx, span, order, rtol, atol, y, dy, work):
    """A first step [s] for an error estimate of the given order; takes one evaluation.

    y and dy (d,) are scratch. Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I,
    section II.4, "Starting step size".
    """
    size = scaled_norm(x, x, rtol, atol)
    speed = scaled_norm(dx, x, rtol, atol)
    h = 1e-6 if size < 1e-5 or speed < 1e-5 else 0.01 * size / speed
    h = min(h, span)
    for i in range(x.size):
        y[i] = x[i] + h * dx[i]
    rhs(kernel, t + h, y, dy, work)
    for i in range(x.size):
        dy[i] -= dx[i]
    curvature = scaled_norm(dy, x, rtol, atol) / h
    fastest = max(speed, curvature)
    further = max(1e-6, 1e-3 * h) if fastest <= 1e-15 else (0.01 / fastest) ** (1.0 / (order + 1))
    if not np.isfinite(further):
        further = h
    return min(100.0 * h, further, span)


@njit(error_model="numpy", _nrt=False)
def smallest_step(t):
    """The step [s] below which t + h and its stages fall together."""
    return max(10.0 * _EPSILON * abs(t), 1e-300)


_END = len(DOP853.method.c)  # the stage that holds f at the end of a step, the next one's first
_FURTHER = len(DOP853.further.c)
_ROWS = _END + 1 + _FURTHER
_SAFETY = 0.9
_SHRINK = 1.0 / 3.0
_GROW = 6.0


@njit(error_model="numpy", _nrt=False)
def _interpolate(theta, x, dense, sample):
    """The dense output at t + θ h."""
    rest = 1.0 - theta
    for i in range(x.size):
        value = dense[4, i] + rest * (dense[5, i] + theta * dense[6, i])
        value = dense[2, i] + rest * (dense[3, i] + theta * value)
        value = dense[0, i] + rest * (dense[1, i] + theta * value)
        sample[i] = x[i] + theta * value


@njit(error_model="numpy", _nrt=False)
def _integrate(constant, kernel, t, x, rtol, atol, work, k, dense, y, now, new):
    """As `run_dop853`, with workspaces; apart from it because reference counts in the loop cost time."""
    d = states(constant, x[0])
    for i in range(d):
        now[i] = x[0, i]
    time = t[0]
    end = t[-1]
    steps = 0
    row = 1
    rhs(kernel, time, now, k[0], work)
    evaluations = 1
    if not all_finite(k[0]):
        return row, time, evaluations, steps, NOT_FINITE
    h = first_step(kernel, time, now, k[0], end - time, 7, rtol, atol, y, new, work)
    evaluations += 1
    rejected = False
    finite = True
    while row < t.size:
        if not h >= smallest_step(time):
            return row, time, evaluations, steps, STEP_TOO_SMALL if finite else NOT_FINITE
        last = time + 1.01 * h >= end
        if last:
            h = end - time
        dop853_step(kernel, time, h, now, new, k, y, work, constant)
        evaluations += _END - 1
        square_3, square_5 = dop853_error(now, new, k, rtol, atol, constant)
        denominator = square_5 + 0.01 * square_3
        error = h * square_5 / np.sqrt(denominator * d) if denominator > 0.0 else 0.0
        if denominator == denominator and error <= 1.0:
            rhs(kernel, time + h, new, k[_END], work)
            evaluations += 1
            finite = all_finite(new) and all_finite(k[_END])
        else:
            finite = all_finite(new)
        # error^(−1/8) by three roots, several times faster than a power
        factor = _SAFETY / np.sqrt(np.sqrt(np.sqrt(error))) if error > 0.0 else _GROW
        if not finite or not error <= 1.0:
            h *= max(_SHRINK, factor) if error > 1.0 and finite else _SHRINK
            rejected = True
            continue
        if t[row] < time + h:
            dop853_dense(kernel, time, h, now, new, dense, k, y, work, constant)
            evaluations += _FURTHER
            while t[row] < time + h and row < t.size - 1:
                _interpolate((t[row] - time) / h, now, dense, x[row])
                row += 1
        if last or t[row] == time + h:
            for i in range(d):
                x[row, i] = new[i]
            row += 1
        for i in range(d):
            now[i] = new[i]
            k[0, i] = k[_END, i]
        time = end if last else time + h
        steps += 1
        h *= min(1.0 if rejected else _GROW, max(_SHRINK, factor))
        rejected = False
    return row, time, evaluations, steps, COMPLETED


@njit(cache=True, nogil=True, error_model="numpy")
def run_dop853(constant, kernel, t, x, rtol, atol, work):
    """Fill x (m, d) from its first row at times t (m,), to relative and absolute tolerance a step.

    Returns the rows filled, the time of the last accepted state, evaluations, accepted steps, a status.
    """
    d = states(constant, x[0])
    k = np.empty((_ROWS, d))
    dense = np.empty((7, d))
    y = np.empty(d)
    now = np.empty(d)
    new = np.empty(d)
    return _integrate(constant, kernel, t, x, rtol, atol, work, k, dense, y, now, new)
