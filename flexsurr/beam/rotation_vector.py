"""Rotations by a vector u: about its direction, by its length, down to none.

    R(u) = 1 + c₁ [u] + c₂ [u]²                the rotation (Rodrigues)
    T(u) = 1 − c₂ [u] + c₃ [u]²                its tangent: ω = T(u) u̇ in the turned frame, R T = Tᵀ

with [u] v = u × v and Stumpff's functions c_k(s) = Σ_j (−s)^j / (k + 2j)! of s = |u|², which are sines and
cosines over powers of the angle without the division. They satisfy

    c_k = 1/k! − s c_{k+2},      dc₂/ds = c₄ − ½ c₃,      dc₃/ds = ³⁄₂ c₅ − ½ c₄.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT, Array

# Terms of c₄ and c₅: those left out are below 1e-16 for angles up to a full turn.
_TERMS = 16
_C4 = tuple((-1.0) ** j / math.factorial(4 + 2 * j) for j in range(_TERMS))
_C5 = tuple((-1.0) ** j / math.factorial(5 + 2 * j) for j in range(_TERMS))


def stumpff(s: Any) -> tuple[Any, Any, Any, Any, Any]:
    """c₁ … c₅ at s, whatever adds and multiplies: real or complex numbers (...,), expressions of them."""
    c4, c5 = _C4[-2] + _C4[-1] * s, _C5[-2] + _C5[-1] * s
    for of_4, of_5 in zip(_C4[-3::-1], _C5[-3::-1], strict=True):
        c4, c5 = of_4 + s * c4, of_5 + s * c5
    c3 = 1.0 / 6.0 - s * c5
    return 1.0 - s * c3, 0.5 - s * c4, c3, c4, c5


def crosses(u: Array) -> Array:
    """(..., 3, 3) [u] of vectors u (..., 3)."""
    matrix = np.zeros((*u.shape, 3), dtype=u.dtype)
    x, y, z = u[..., 0], u[..., 1], u[..., 2]
    matrix[..., 0, 1], matrix[..., 0, 2] = -z, y
    matrix[..., 1, 0], matrix[..., 1, 2] = z, -x
    matrix[..., 2, 0], matrix[..., 2, 1] = -y, x
    return matrix


def rotation(u: Array) -> tuple[Array, Array]:
    """R and T (..., 3, 3) of vectors u (..., 3) [rad], real or complex."""
    c1, c2, c3, _, _ = (c[..., None, None] for c in stumpff(np.sum(u * u, axis=-1)))
    once = crosses(u)
    twice = once @ once
    return np.eye(3) + c1 * once + c2 * twice, np.eye(3) - c2 * once + c3 * twice


def tangent_rate(u: Array, rate: Array) -> Array:
    """(..., 3, 3) the rate of Tᵀ = 1 + c₂ [u] + c₃ [u]² as u (..., 3) changes at `rate` u̇ (..., 3)."""
    _, c2, c3, c4, c5 = (c[..., None, None] for c in stumpff(np.sum(u * u, axis=-1)))
    growth = 2.0 * np.sum(u * rate, axis=-1)[..., None, None]
    at, moves = crosses(u), crosses(rate)
    of_c2, of_c3 = growth * (c4 - 0.5 * c3), growth * (1.5 * c5 - 0.5 * c4)
    return np.asarray(of_c2 * at + of_c3 * at @ at + c2 * moves + c3 * (moves @ at + at @ moves))


@njit(fastmath=FLOATING_POINT, error_model="numpy", forceinline=True, cache=True)
def stumpff_4_5(s):
    """(c₄, c₅) at s, compiled; the others follow from them."""
    c4 = c5 = 0.0
    for j in range(_TERMS - 1, -1, -1):
        c4 = _C4[j] + s * c4
        c5 = _C5[j] + s * c5
    return c4, c5
