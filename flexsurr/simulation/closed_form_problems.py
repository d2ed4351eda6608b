"""Problems with known solutions, as models and kernels: what integrators are held against.

They lie in the package since machine code is kept by its sources: with kernels from outside, whoever steps
these would have every other kernel compiled once more.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from flexsurr.simulation.jacobian import implements_jacobian, jacobian
from flexsurr.simulation.rhs import Array, ByKernel, implements_rhs


class _NumberedStates:
    """States that have no other names than x_0, x_1, …, and no dimensions."""

    states: int

    @property
    def state_names(self) -> tuple[str, ...]:
        """x_0, x_1, …"""
        return tuple(f"x_{i}" for i in range(self.states))

    @property
    def state_units(self) -> tuple[str, ...]:
        """Without dimensions."""
        return ("1",) * self.states


@dataclass(frozen=True)
class KernelModel(_NumberedStates, ByKernel):
    """A compiled model made of nothing but a kernel."""

    kernel: Any
    states: int
    breakpoints: tuple[float, ...] = ()
    work_size: int = 0


@dataclass(frozen=True)
class PythonModel(_NumberedStates):
    """A model that has no compiled form: ẋ = function(t, x)."""

    function: Callable[[float, Array], Array]
    states: int = 1
    breakpoints: tuple[float, ...] = ()

    def derivative(self, t: float, x: Array) -> Array:
        """The rates at time t [s]."""
        return self.function(t, x)


OSCILLATOR, FORCED, PULSED, PENDULUM, VAN_DER_POL, PROTHERO_ROBINSON, DECAY, BLOW_UP, BREAKS_OFF = range(9)


class Planar(NamedTuple):
    """Equations of two states, chosen by number so that each integrator is compiled once for all of them."""

    problem: int
    a: float = 0.0
    b: float = 0.0


@implements_rhs(Planar)
def _planar(kernel, t, x, dx, work):
    a = kernel.a
    b = kernel.b
    dx[0] = x[1]
    dx[1] = 0.0
    if kernel.problem == OSCILLATOR:
        dx[1] = -a * a * x[0]
    elif kernel.problem == FORCED:
        dx[1] = -a * a * x[0] + np.cos(b * t)
    elif kernel.problem == PULSED:
        dx[1] = -a * a * x[0] + (1.0 if t < b else 0.0)
    elif kernel.problem == PENDULUM:
        dx[1] = -np.sin(x[0])
    elif kernel.problem == VAN_DER_POL:
        dx[1] = a * (1.0 - x[0] * x[0]) * x[1] - x[0]
    elif kernel.problem == PROTHERO_ROBINSON:
        dx[0] = -a * (x[0] - np.cos(t)) - np.sin(t)
    elif kernel.problem == DECAY:
        dx[0] = -a * x[0]
    elif kernel.problem == BLOW_UP:
        dx[0] = x[0] * x[0]
    elif kernel.problem == BREAKS_OFF:
        dx[0] = 1.0 if t < b else np.nan


def planar(problem: int, a: float = 0.0, b: float = 0.0, breakpoints: tuple[float, ...] = ()) -> KernelModel:
    """One of the problems above, with its two constants."""
    return KernelModel(Planar(problem, a, b), 2, breakpoints)


def forced_solution(t: Array, a: float, b: float) -> Array:
    """q̈ + a² q = cos(b t) from rest, b ≠ a."""
    return (np.cos(b * t) - np.cos(a * t)) / (a * a - b * b)


def pulsed_solution(t: Array, a: float, b: float) -> Array:
    """q̈ + a² q = 1 until b, then 0, from rest."""
    return (np.cos(a * np.maximum(t - b, 0.0)) - np.cos(a * t)) / a**2


class PendulumVariation(NamedTuple):
    """A pendulum (q, p) and the derivative of its flow, by rows."""


@implements_rhs(PendulumVariation)
def _pendulum_variation(kernel, t, x, dx, work):
    slope = -np.cos(x[0])
    dx[0] = x[1]
    dx[1] = -np.sin(x[0])
    for j in range(2):
        dx[2 + j] = x[4 + j]
        dx[4 + j] = slope * x[2 + j]


class VanDerPol(NamedTuple):
    """q̈ = μ (1 − q²) q̇ − q, with its Jacobian."""

    mu: float


@implements_rhs(VanDerPol)
def _van_der_pol(kernel, t, x, dx, work):
    dx[0] = x[1]
    dx[1] = kernel.mu * (1.0 - x[0] * x[0]) * x[1] - x[0]


@implements_jacobian(VanDerPol)
def _van_der_pol_jacobian(kernel, t, x, dx, jac, work):
    jac[0, 0] = 0.0
    jac[0, 1] = 1.0
    jac[1, 0] = -2.0 * kernel.mu * x[0] * x[1] - 1.0
    jac[1, 1] = kernel.mu * (1.0 - x[0] * x[0])
    return 0


@njit(cache=True)
def evaluate_jacobian(kernel, t, x, dx, jac, work):
    """`jacobian` as a call from Python."""
    return jacobian(kernel, t, x, dx, jac, work)
