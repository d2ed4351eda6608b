"""Aerodynamics by derivatives: coefficients linear in the features about a point, as in the textbooks."""

from typing import NamedTuple

import numpy as np

from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES
from flexsurr.simulation.mapping import CompiledMapping, implements_mapping
from flexsurr.simulation.rhs import Array


class LinearAerodynamics(NamedTuple):
    """y = y₀ + D (u − u₀), with u₀ (25,), y₀ (12,) and the derivatives D (12, 25)."""

    about: Array
    value: Array
    slopes: Array


def linear_aerodynamics(about: Array, value: Array, slopes: Array) -> CompiledMapping:
    """From the 25 features to the 12 coefficients. Raises ValueError for arrays of other shapes."""
    shapes = ((len(FEATURES),), (len(COEFFICIENTS),), (len(COEFFICIENTS), len(FEATURES)))
    arrays = [np.array(array, dtype=np.float64) for array in (about, value, slopes)]
    for name, array, shape in zip(LinearAerodynamics._fields, arrays, shapes, strict=True):
        if array.shape != shape:
            raise ValueError(f"{name}: has the shape {array.shape}; expected {shape}")
    return CompiledMapping(LinearAerodynamics(*arrays), 0, FEATURES, COEFFICIENTS)


def derivatives(aerodynamics: CompiledMapping, about: Array, step: float = 1e-5) -> Array:
    """∂y/∂u (12, 25) of an aerodynamics at the features `about` (25,), by central differences.

    `step` is relative where a feature is not small (Mach number, altitude), absolute where it is.
    """
    steps = step * np.maximum(1.0, np.abs(about))
    points = about + np.concatenate([np.diag(steps), -np.diag(steps)])
    values = aerodynamics(points)
    count = len(about)
    return (values[:count] - values[count:]).T / (2.0 * steps)


@implements_mapping(LinearAerodynamics)
def _linear(kernel, u, y, work):
    for i in range(y.size):
        total = kernel.value[i]
        for j in range(u.size):
            total += kernel.slopes[i, j] * (u[j] - kernel.about[j])
        y[i] = total
