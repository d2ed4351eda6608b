"""Sums over samples of a network's squared error and its derivatives, compiled.

Everything here is in scaled states. The loss is Σ_i w_i ⟨(f_i − y_i)²⟩, with a weight for each output;
weights of one over the output's variance and their number make it the nmse, equal ones the mean of squares.
Without weights it is ⟨‖f_q − y_q‖ + ‖f_p − y_p‖⟩: the norms of eqs. 11 and 12, their mean over the samples.
"""

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT
from flexsurr.training.backpropagation import accumulate, field, propagate

CACHED = {"cache": True, "fastmath": FLOATING_POINT, "error_model": "numpy"}


@njit(**CACHED)
def fields(kernel, x, work):
    """The scaled field at the scaled states `x` (m, 2r), shape (m, 2r)."""
    parameters = kernel.parameters
    result = np.empty(x.shape)
    for s in range(len(x)):
        propagate(kernel, parameters, x[s], work)
        field(kernel, parameters, work, result[s])
    return result


@njit(**CACHED)
def loss_and_gradient(kernel, x, y, weights, chosen, gradient, work):
    """The loss over the samples `chosen` (indices), and its gradient written into `gradient`.

    Weights of zero stand for the norms.
    """
    parameters = kernel.parameters
    gradient[:] = 0.0
    v = np.empty(x.shape[1])
    loss = 0.0
    for s in chosen:
        propagate(kernel, parameters, x[s], work)
        field(kernel, parameters, work, v)
        if weights[0] == 0.0:
            loss += _norms(v, y[s]) / len(chosen)
            for i in range(v.size):
                v[i] /= len(chosen)
        else:
            for i in range(v.size):
                residual = v[i] - y[s, i]
                v[i] = weights[i] * residual / len(chosen)
                loss += v[i] * residual
                v[i] *= 2.0
        accumulate(kernel, parameters, v, gradient, work)
    return loss


@njit(**CACHED)
def _norms(v, y):
    """‖v_q − y_q‖ + ‖v_p − y_p‖ of a field `v` (2r,), in whose place its derivatives by `v` are left."""
    r = v.size // 2
    total = 0.0
    for first in (0, r):
        square = 0.0
        for i in range(first, first + r):
            v[i] -= y[i]
            square += v[i] * v[i]
        norm = np.sqrt(square)
        total += norm
        for i in range(first, first + r):
            v[i] = v[i] / norm if norm > 0.0 else 0.0 * v[i]
    return total


@njit(**CACHED)
def residuals_and_jacobian(kernel, x, y, roots, residuals, jacobian, work):
    """Rows √w_i (f_i − y_i) into `residuals` (m · 2r,) and their derivatives into `jacobian`.

    Sample by sample; `roots` (2r,) holds √w_i, `jacobian` is (m · 2r, parameters).
    """
    parameters = kernel.parameters
    d = x.shape[1]
    v = np.zeros(d)
    dx = np.empty(d)
    for s in range(len(x)):
        propagate(kernel, parameters, x[s], work)
        field(kernel, parameters, work, dx)
        for i in range(d):
            residuals[s * d + i] = roots[i] * (dx[i] - y[s, i])
            v[i] = roots[i]
            jacobian[s * d + i] = 0.0
            accumulate(kernel, parameters, v, jacobian[s * d + i], work)
            v[i] = 0.0
