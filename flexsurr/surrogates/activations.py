"""Activation functions σ with σ′ and σ″, for arrays and for compiled loops.

A Hamiltonian network needs σ′ to be evaluated and σ″ to be trained. Each formula is written once, in terms
of functions that numba knows of one number and NumPy of arrays. In compiled code it is chosen by the class
of an empty NamedTuple, when the code is compiled: no branch runs per neuron and the loop over neurons
vectorises.

    name        σ(z)                    σ′(z)                   σ″
    elu         z, z > 0; eᶻ − 1        1, z > 0; eᶻ            jumps at 0
    tanh        tanh z                  1 − tanh² z
    softplus    log(1 + eᶻ)             s = 1 / (1 + e⁻ᶻ)
    silu        z s                     s (1 + z (1 − s))
    squareplus  (z + √(z² + 4)) / 2     (1 + z / √(z² + 4)) / 2
    half_log    ½ log(1 + z²)           z / (1 + z²)            rational from σ′ on
    atan        arctan z                1 / (1 + z²)            rational from σ′ on
    cube        z³ / 3                  z²                      2 z

A call into the C library keeps a loop from being vectorised, so the exponential and the logarithm are a few
lines that inline into it: the exponent of a double is read and set as an integer, the rest is a polynomial.
Relative error below 1e-14 between −700 and 700, which is where the exponential's argument is held.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.extending import overload

from flexsurr.simulation.rhs import FLOATING_POINT, Array

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


class Elu(NamedTuple):
    """Exponential linear unit."""


class Tanh(NamedTuple):
    """Hyperbolic tangent."""


class Softplus(NamedTuple):
    """Integral of the logistic function."""


class Silu(NamedTuple):
    """z times the logistic function."""


class Squareplus(NamedTuple):
    """Algebraic neighbour of softplus."""


class HalfLog(NamedTuple):
    """½ log(1 + z²), even, with a rational slope."""


class Atan(NamedTuple):
    """Arctangent, with a rational slope."""


class Cube(NamedTuple):
    """z³ / 3: nothing but products, and as unbounded as a polynomial."""


@dataclass(frozen=True)
class ActivationFunction:
    """σ, σ′ and σ″ of arrays of any shape, and the class that selects them in compiled code."""

    value: Callable[[Array], Array]
    slope: Callable[[Array], Array]
    curvature: Callable[[Array], Array]
    tag: NamedTuple


def value(tag: Any, z: float) -> float:
    """σ(z) of the activation `tag`, from compiled code only."""
    raise TypeError(f"{tag} is an activation of compiled code")


def slope(tag: Any, z: float) -> float:
    """σ′(z) of the activation `tag`, from compiled code only."""
    raise TypeError(f"{tag} is an activation of compiled code")


def curvature(tag: Any, z: float) -> float:
    """σ″(z) of the activation `tag`, from compiled code only."""
    raise TypeError(f"{tag} is an activation of compiled code")


def two_slopes(tag: Any, y: float, z: float) -> tuple[float, float]:
    """σ′(y) and σ′(z) of the activation `tag`, from compiled code only: quotients share one division."""
    raise TypeError(f"{tag} is an activation of compiled code")


Function = Callable[..., Any]


class Functions(NamedTuple):
    """What the formulas are made of, for numbers, arrays or whatever else has them.

    `above` is max(z, 0), `below` min(z, 0).
    """

    exp: Function
    log: Function
    sqrt: Function
    atan: Function
    tanh: Function
    logistic: Function
    above: Function
    below: Function


def formulas(functions: Functions) -> dict[str, tuple[Function, Function, Function]]:
    """σ, σ′ and σ″ of every activation."""
    exp, log, sqrt, atan, tanh, logistic, above, below = functions

    def tanh_curvature(z: Any) -> Any:
        t = tanh(z)
        return -2.0 * t * (1.0 - t * t)

    def silu_curvature(z: Any) -> Any:
        s = logistic(z)
        return s * (1.0 - s) * (2.0 + z * (1.0 - 2.0 * s))

    return {
        "elu": (
            lambda z: above(z) + exp(below(z)) - 1.0,
            lambda z: exp(below(z)),
            lambda z: exp(below(z)) * (z < 0.0),
        ),
        "tanh": (
            lambda z: tanh(z),
            lambda z: 1.0 - tanh(z) ** 2,
            tanh_curvature,
        ),
        "softplus": (
            lambda z: above(z) + log(1.0 + exp(-abs(z))),
            lambda z: logistic(z),
            lambda z: logistic(z) * logistic(-z),
        ),
        "silu": (
            lambda z: z * logistic(z),
            lambda z: logistic(z) * (1.0 + z * logistic(-z)),
            silu_curvature,
        ),
        "squareplus": (
            lambda z: 0.5 * (z + sqrt(z * z + 4.0)),
            lambda z: 0.5 + 0.5 * z / sqrt(z * z + 4.0),
            lambda z: 2.0 / ((z * z + 4.0) * sqrt(z * z + 4.0)),
        ),
        "half_log": (
            lambda z: 0.5 * log(1.0 + z * z),
            lambda z: z / (1.0 + z * z),
            lambda z: (2.0 / (1.0 + z * z) - 1.0) / (1.0 + z * z),
        ),
        "atan": (
            lambda z: atan(z),
            lambda z: 1.0 / (1.0 + z * z),
            lambda z: -2.0 * z / (1.0 + z * z) / (1.0 + z * z),
        ),
        "cube": (
            lambda z: z * z * z / 3.0,
            lambda z: z * z,
            lambda z: 2.0 * z,
        ),
    }


OPTIONS = {"fastmath": FLOATING_POINT, "error_model": "numpy"}

OF_NUMBERS = Functions(
    exponential,
    logarithm,
    math.sqrt,
    math.atan,
    njit(**OPTIONS)(lambda z: 1.0 - 2.0 / (1.0 + exponential(2.0 * z))),
    njit(**OPTIONS)(lambda z: 1.0 / (1.0 + exponential(-z))),
    njit(**OPTIONS)(lambda z: z if z > 0.0 else 0.0),
    njit(**OPTIONS)(lambda z: 0.0 if z > 0.0 else z),
)
OF_ARRAYS = Functions(
    np.exp,
    np.log,
    np.sqrt,
    np.arctan,
    np.tanh,
    lambda z: 0.5 + 0.5 * np.tanh(0.5 * z),  # overflows nowhere
    lambda z: np.maximum(z, 0.0),
    lambda z: np.minimum(z, 0.0),
)


TAGS: dict[str, Any] = {
    "elu": Elu(),
    "tanh": Tanh(),
    "softplus": Softplus(),
    "silu": Silu(),
    "squareplus": Squareplus(),
    "half_log": HalfLog(),
    "atan": Atan(),
    "cube": Cube(),
}


def _compile(generic: Function, tag_class: type, formula: Function) -> None:
    of_number = njit(**OPTIONS)(formula)

    @overload(generic, jit_options=OPTIONS)
    def resolve(tag, z):
        if isinstance(tag, types.BaseNamedTuple) and tag.instance_class is tag_class:
            return lambda tag, z: of_number(z)
        return None


for _name, _compiled_formulas in formulas(OF_NUMBERS).items():
    for _generic, _formula in zip((value, slope, curvature), _compiled_formulas, strict=True):
        _compile(_generic, type(TAGS[_name]), _formula)

_QUOTIENTS = {"half_log": lambda z: z, "atan": lambda z: 1.0}
"""Numerators of the slopes over 1 + z²."""


def _with_one_division(numerator: Function) -> Function:
    of_number = njit(**OPTIONS)(numerator)

    @njit(**OPTIONS)
    def quotients(y, z):
        of_y, of_z = 1.0 + y * y, 1.0 + z * z
        inverse = 1.0 / (of_y * of_z)
        return of_number(y) * of_z * inverse, of_number(z) * of_y * inverse

    return lambda tag, y, z: quotients(y, z)


_PAIRS: dict[Any, Function] = {
    type(TAGS[name]): _with_one_division(numerator) for name, numerator in _QUOTIENTS.items()
}


@overload(two_slopes, jit_options=OPTIONS)
def _two_slopes(tag, y, z):
    return _PAIRS.get(tag.instance_class, lambda tag, y, z: (slope(tag, y), slope(tag, z)))


ACTIVATIONS = {
    name: ActivationFunction(*of_arrays, TAGS[name]) for name, of_arrays in formulas(OF_ARRAYS).items()
}


def activation_function(name: str) -> ActivationFunction:
    """The activation of this name. Raises ValueError where there is none."""
    if name not in ACTIVATIONS:
        raise ValueError(f"activation {name!r} is not one of {', '.join(ACTIVATIONS)}")
    return ACTIVATIONS[name]
