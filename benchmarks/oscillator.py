"""A small model to time integrators with: two states, polynomials as a fitted surrogate has them."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from flexsurr.simulation import Array, evaluate, implements_rhs


class Oscillator(NamedTuple):
    """H = ½ p² (1 + α q²) + ½ ω² q² (1 + β q²)."""

    omega: float
    alpha: float
    beta: float


@implements_rhs(Oscillator)
def _oscillator(kernel, t, x, dx, work):
    q, p = x[0], x[1]
    square = q * q
    dx[0] = p * (1.0 + kernel.alpha * square)
    dx[1] = -kernel.alpha * q * p * p - kernel.omega * kernel.omega * q * (1.0 + 2.0 * kernel.beta * square)


@dataclass(frozen=True)
class OscillatorModel:
    kernel: Oscillator = field(default_factory=lambda: Oscillator(55.0, 0.1, 0.1))
    work_size: int = 0
    breakpoints: tuple[float, ...] = ()
    state_names: tuple[str, ...] = ("q", "p")
    state_units: tuple[str, ...] = ("1", "1/s")

    def derivative(self, t: float, x: Array) -> Array:
        dx = np.empty(2)
        evaluate(self.kernel, t, x, dx, np.empty(0))
        return dx
