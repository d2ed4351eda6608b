"""Problems with known solutions, as models and kernels.

A module of its own, so that code compiled for these kernels can be kept on disk.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from flexsurr.simulation import Array, evaluate, implements_rhs


@dataclass(frozen=True)
class KernelModel:
    """A compiled model made of nothing but a kernel."""

    kernel: Any
    states: int
    breakpoints: tuple[float, ...] = ()
    work_size: int = 0

    @property
    def state_names(self) -> tuple[str, ...]:
        return tuple(f"x_{i}" for i in range(self.states))

    @property
    def state_units(self) -> tuple[str, ...]:
        return ("1",) * self.states

    def derivative(self, t: float, x: Array) -> Array:
        dx = np.empty(self.states)
        evaluate(self.kernel, float(t), np.ascontiguousarray(x), dx, np.empty(self.work_size))
        return dx


@dataclass(frozen=True)
class PythonModel:
    """A model that has no compiled form."""

    function: Callable[[float, Array], Array]
    states: int = 1
    breakpoints: tuple[float, ...] = ()

    @property
    def state_names(self) -> tuple[str, ...]:
        return tuple(f"x_{i}" for i in range(self.states))

    @property
    def state_units(self) -> tuple[str, ...]:
        return ("1",) * self.states

    def derivative(self, t: float, x: Array) -> Array:
        return self.function(t, x)


class Oscillator(NamedTuple):
    """q̈ = −ω² q − ε q³."""

    omega: float
    cubic: float


@implements_rhs(Oscillator)
def _oscillator(kernel, t, x, dx, work):
    dx[0] = x[1]
    dx[1] = -kernel.omega * kernel.omega * x[0] - kernel.cubic * x[0] * x[0] * x[0]
