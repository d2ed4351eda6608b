"""What adaptive integrators share: the scaled norm, the first step, the smallest step."""

import numpy as np
from numba import njit

from flexsurr.simulation.dimension import ORDERED
from flexsurr.simulation.rhs import rhs

_EPSILON = float(np.finfo(np.float64).eps)


@njit(error_model="numpy", fastmath=ORDERED, _nrt=False)
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
