"""Activation functions σ with σ′ and σ″, for arrays and for compiled loops.

A Hamiltonian network needs σ′ to be evaluated and σ″ to be trained. In compiled code the function is
chosen by the class of an empty NamedTuple, when the code is compiled: no branch runs per neuron and
the loop over neurons vectorises.

    name        σ(z)                    σ′(z)                   σ″
    elu         z, z > 0; eᶻ − 1        1, z > 0; eᶻ            jumps at 0
    tanh        tanh z                  1 − tanh² z
    softplus    log(1 + eᶻ)             s = 1 / (1 + e⁻ᶻ)
    silu        z s                     s (1 + z (1 − s))
    squareplus  (z + √(z² + 4)) / 2     (1 + z / √(z² + 4)) / 2
    half_log    ½ log(1 + z²)           z / (1 + z²)            rational from σ′ on
    atan        arctan z                1 / (1 + z²)            rational from σ′ on
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.extending import overload

from flexsurr.simulation.rhs import FLOATING_POINT, Array
from flexsurr.surrogates.elementary import exponential, logarithm


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


def _compile(
    tag_class: type, sigma: Callable[..., float], first: Callable[..., float], second: Callable[..., float]
) -> None:
    for generic, formula in ((value, sigma), (slope, first), (curvature, second)):
        _register(generic, tag_class, formula)


def _register(generic: Callable[..., float], tag_class: type, formula: Callable[..., float]) -> None:
    @overload(generic, jit_options={"fastmath": FLOATING_POINT, "error_model": "numpy"})
    def resolve(tag, z):
        if isinstance(tag, types.BaseNamedTuple) and tag.instance_class is tag_class:
            return formula
        return None


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def _logistic(z):
    return 1.0 / (1.0 + exponential(-z))


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def _tanh(z):
    return 1.0 - 2.0 / (1.0 + exponential(2.0 * z))


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def _silu_curvature(z):
    s = _logistic(z)
    return s * (1.0 - s) * (2.0 + z * (1.0 - 2.0 * s))


def _array_logistic(z: Array) -> Array:
    return 0.5 + 0.5 * np.tanh(0.5 * z)  # overflows nowhere


def _array_silu_curvature(z: Array) -> Array:
    s = _array_logistic(z)
    return s * (1.0 - s) * (2.0 + z * (1.0 - 2.0 * s))


_compile(
    Elu,
    lambda tag, z: (z if z > 0.0 else 0.0) + exponential(0.0 if z > 0.0 else z) - 1.0,
    lambda tag, z: exponential(0.0 if z > 0.0 else z),
    lambda tag, z: exponential(z) if z < 0.0 else 0.0,
)
_compile(
    Tanh,
    lambda tag, z: _tanh(z),
    lambda tag, z: 1.0 - _tanh(z) ** 2,
    lambda tag, z: -2.0 * _tanh(z) * (1.0 - _tanh(z) ** 2),
)
_compile(
    Softplus,
    lambda tag, z: (z if z > 0.0 else 0.0) + logarithm(1.0 + exponential(-abs(z))),
    lambda tag, z: _logistic(z),
    lambda tag, z: _logistic(z) * (1.0 - _logistic(z)),
)
_compile(
    Silu,
    lambda tag, z: z * _logistic(z),
    lambda tag, z: _logistic(z) * (1.0 + z * (1.0 - _logistic(z))),
    lambda tag, z: _silu_curvature(z),
)
_compile(
    Squareplus,
    lambda tag, z: 0.5 * (z + math.sqrt(z * z + 4.0)),
    lambda tag, z: 0.5 + 0.5 * z / math.sqrt(z * z + 4.0),
    lambda tag, z: 2.0 / ((z * z + 4.0) * math.sqrt(z * z + 4.0)),
)
_compile(
    HalfLog,
    lambda tag, z: 0.5 * logarithm(1.0 + z * z),
    lambda tag, z: z / (1.0 + z * z),
    lambda tag, z: (2.0 / (1.0 + z * z) - 1.0) / (1.0 + z * z),
)
_compile(
    Atan,
    lambda tag, z: math.atan(z),
    lambda tag, z: 1.0 / (1.0 + z * z),
    lambda tag, z: -2.0 * z / (1.0 + z * z) / (1.0 + z * z),
)

ACTIVATIONS: dict[str, ActivationFunction] = {
    "elu": ActivationFunction(
        value=lambda z: np.where(z > 0.0, z, np.expm1(np.minimum(z, 0.0))),
        slope=lambda z: np.exp(np.minimum(z, 0.0)),
        curvature=lambda z: np.where(z < 0.0, np.exp(np.minimum(z, 0.0)), 0.0),
        tag=Elu(),
    ),
    "tanh": ActivationFunction(
        value=np.tanh,
        slope=lambda z: 1.0 - np.tanh(z) ** 2,
        curvature=lambda z: -2.0 * np.tanh(z) * (1.0 - np.tanh(z) ** 2),
        tag=Tanh(),
    ),
    "softplus": ActivationFunction(
        value=lambda z: np.logaddexp(0.0, z),
        slope=_array_logistic,
        curvature=lambda z: _array_logistic(z) * _array_logistic(-z),
        tag=Softplus(),
    ),
    "silu": ActivationFunction(
        value=lambda z: z * _array_logistic(z),
        slope=lambda z: _array_logistic(z) * (1.0 + z * _array_logistic(-z)),
        curvature=_array_silu_curvature,
        tag=Silu(),
    ),
    "squareplus": ActivationFunction(
        value=lambda z: 0.5 * (z + np.sqrt(z * z + 4.0)),
        slope=lambda z: 0.5 + 0.5 * z / np.sqrt(z * z + 4.0),
        curvature=lambda z: 2.0 / ((z * z + 4.0) * np.sqrt(z * z + 4.0)),
        tag=Squareplus(),
    ),
    "half_log": ActivationFunction(
        value=lambda z: 0.5 * np.log1p(z * z),
        slope=lambda z: z / (1.0 + z * z),
        curvature=lambda z: (2.0 / (1.0 + z * z) - 1.0) / (1.0 + z * z),
        tag=HalfLog(),
    ),
    "atan": ActivationFunction(
        value=np.arctan,
        slope=lambda z: 1.0 / (1.0 + z * z),
        curvature=lambda z: -2.0 * z / (1.0 + z * z) / (1.0 + z * z),
        tag=Atan(),
    ),
}
