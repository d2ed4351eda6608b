"""The Jacobian ∂f/∂x that implicit integrators need: finite differences unless a kernel brings its own."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import types
from numba.extending import overload

from flexsurr.simulation.dimension import ORDERED
from flexsurr.simulation.rhs import Array, rhs

_analytic: dict[type, Callable[..., int]] = {}

_EPSILON = float(np.finfo(np.float64).eps)
# Increments √(ε max(|x_j|, 1e-5)): Hairer, Wanner, Solving Ordinary Differential Equations II, code RADAU5.
_SMALLEST_STATE = 1e-5


def jacobian(kernel: Any, t: float, x: Array, dx: Array, jac: Array, work: Array) -> int:
    """Write ∂f_i/∂x_j into jac (d, d); `dx` (d,) is f(t, x). Returns the evaluations of f it took.

    Callable from compiled code only.
    """
    raise TypeError("call jacobian from compiled code")


def implements_jacobian(kernel_class: type) -> Callable[[Callable[..., int]], Callable[..., int]]:
    """Register the decorated (kernel, t, x, dx, jac, work) -> evaluations as `jacobian` of `kernel_class`."""

    def register(derivatives: Callable[..., int]) -> Callable[..., int]:
        _analytic[kernel_class] = derivatives
        return derivatives

    return register


def _finite_differences(kernel, t, x, dx, jac, work):
    d = x.size
    for j in range(d):
        kept = x[j]
        x[j] = kept + np.sqrt(_EPSILON * max(abs(kept), _SMALLEST_STATE))
        increment = x[j] - kept
        column = jac[j]  # as a row for the while, where rhs can write it
        rhs(kernel, t, x, column, work)
        x[j] = kept
        for i in range(d):
            column[i] = (column[i] - dx[i]) / increment
    for i in range(d):
        for j in range(i):
            jac[i, j], jac[j, i] = jac[j, i], jac[i, j]
    return d


@overload(jacobian, jit_options={"fastmath": ORDERED, "error_model": "numpy", "_nrt": False})
def _resolve(kernel, t, x, dx, jac, work):
    if isinstance(kernel, types.BaseNamedTuple):
        return _analytic.get(kernel.instance_class, _finite_differences)
    return None
