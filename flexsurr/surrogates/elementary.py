"""Exponential and logarithm for compiled loops over neurons.

A call into the C library keeps a loop from being vectorised; these few lines inline into it. The
exponent of a double is read and set as an integer, the rest is a polynomial. Relative error below
1e-14 between −700 and 700, which is where the exponential's argument is held.
"""

import math

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT

LOG2_E = 1.0 / math.log(2.0)
LN_2 = math.log(2.0)
EXPONENT_BIAS = 1023
MANTISSA_BITS = 52
MANTISSA = (1 << MANTISSA_BITS) - 1
SQRT_HALF_BITS = int(np.float64(math.sqrt(0.5)).view(np.int64)) & MANTISSA

# Taylor about 0 on |x| ≤ ½ ln 2: the next term is below 2^-53.
E2, E3, E4, E5, E6, E7, E8, E9, E10, E11, E12 = (1.0 / math.factorial(k) for k in range(2, 13))
# log m = 2 artanh s, s = (m − 1) / (m + 1), on |s| ≤ 0.172.
L3, L5, L7, L9, L11, L13, L15, L17, L19, L21 = (2.0 / k for k in range(3, 22, 2))


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def exponential(z):
    """eᶻ, with z held between −700 and 700. NaN stays NaN."""
    z = -700.0 if z < -700.0 else z
    z = 700.0 if z > 700.0 else z
    n = np.floor(z * LOG2_E + 0.5)
    x = z - n * LN_2
    tail = E6 + x * (E7 + x * (E8 + x * (E9 + x * (E10 + x * (E11 + x * E12)))))
    mantissa = 1.0 + x * (1.0 + x * (E2 + x * (E3 + x * (E4 + x * (E5 + x * tail)))))
    # 32-bit on purpose: every vector unit converts doubles to 32-bit integers, few to 64-bit ones.
    exponent = np.int64(np.int32(n) + np.int32(EXPONENT_BIAS))
    return mantissa * np.int64(exponent << MANTISSA_BITS).view(np.float64)


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def logarithm(y):
    """Natural logarithm of a normal positive number."""
    bits = np.float64(y).view(np.int64)
    # m between √½ and √2, so that the series converges quickly on both sides of one
    shifted = bits - SQRT_HALF_BITS
    exponent = (shifted >> MANTISSA_BITS) - (EXPONENT_BIAS - 1)
    m = np.int64(bits - (exponent << MANTISSA_BITS)).view(np.float64)
    s = (m - 1.0) / (m + 1.0)
    w = s * s
    tail = L11 + w * (L13 + w * (L15 + w * (L17 + w * (L19 + w * L21))))
    series = s * (2.0 + w * (L3 + w * (L5 + w * (L7 + w * (L9 + w * tail)))))
    return np.float64(np.int32(exponent)) * LN_2 + series
