"""Loads on the beam: what acts where, and when.

All forces are dead (they keep their direction) and given in the clamp's frame before it is turned.
A load of a fixed shape follows one history: sin(ω t + phase) from its start to its end, nothing outside.
"""

import math
from dataclasses import dataclass

import numpy as np

from flexsurr.beam.chain import chain
from flexsurr.config.structure import Structure
from flexsurr.simulation.rhs import Array

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class History:
    """The factor of a load over time: sin(ω t + phase) for start ≤ t < end, else 0.

    At a jump it has the value of the interval which begins there; `simulate` keeps the stages of the
    interval that ends there short of it by a few floating-point numbers.
    """

    start_s: float = -math.inf
    end_s: float = math.inf
    frequency_rad_s: float = 0.0
    phase_rad: float = 0.5 * math.pi  # with ω = 0: constant

    def __post_init__(self) -> None:
        if not self.start_s < self.end_s:
            raise ValueError(f"a load must end after its start: start {self.start_s} s, end {self.end_s} s")
        if not (math.isfinite(self.frequency_rad_s) and self.frequency_rad_s >= 0.0):
            raise ValueError(f"frequency_rad_s: {self.frequency_rad_s} is not a finite number ≥ 0")

    def factor(self, t: float) -> float:
        """The factor at time t [s]."""
        if not self.start_s <= t < self.end_s:
            return 0.0
        return math.sin(self.frequency_rad_s * t + self.phase_rad)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Times [s] at which the factor may jump."""
        return tuple(time for time in (self.start_s, self.end_s) if math.isfinite(time))


@dataclass(frozen=True)
class DeadTipForce:
    """A constant force at the tip."""

    force_N: Vector

    def __post_init__(self) -> None:
        _check_vector("force_N", self.force_N)

    @property
    def history(self) -> History:
        """Always acting."""
        return History()

    def forces(self, structure: Structure) -> tuple[Array, Array]:
        """Forces on the elements' centres (N, 3) and on the tip (3,) [N], at a factor of 1."""
        return np.zeros((structure.elements, 3)), np.array(self.force_N, dtype=np.float64)


@dataclass(frozen=True)
class SineTipForce:
    """F(t) = amplitude sin(ω t) along `direction` at the tip, from start to end."""

    amplitude_N: float
    frequency_rad_s: float
    direction: Vector = (0.0, 0.0, 1.0)
    start_s: float = 0.0
    end_s: float = math.inf

    def __post_init__(self) -> None:
        _check_vector("direction", self.direction)
        if not math.isfinite(self.amplitude_N):
            raise ValueError(f"amplitude_N: {self.amplitude_N} is not finite")
        if not any(self.direction):
            raise ValueError("direction: the zero vector has no direction")
        _ = self.history

    @property
    def history(self) -> History:
        """A sine from start to end."""
        return History(self.start_s, self.end_s, self.frequency_rad_s, 0.0)

    def forces(self, structure: Structure) -> tuple[Array, Array]:
        """Forces on the elements' centres (N, 3) and on the tip (3,) [N], at a factor of 1."""
        direction = np.array(self.direction, dtype=np.float64)
        return np.zeros((structure.elements, 3)), self.amplitude_N * direction / math.hypot(*direction)


@dataclass(frozen=True)
class DistributedForce:
    """A constant force per length on the elastic axis, from start to end.

    Each element receives the integral over its own span, at its centre.
    """

    force_N_m: Vector
    start_s: float = -math.inf
    end_s: float = math.inf

    def __post_init__(self) -> None:
        _check_vector("force_N_m", self.force_N_m)
        _ = self.history

    @property
    def history(self) -> History:
        """Constant from start to end."""
        return History(self.start_s, self.end_s)

    def forces(self, structure: Structure) -> tuple[Array, Array]:
        """Forces on the elements' centres (N, 3) and on the tip (3,) [N], at a factor of 1."""
        each = np.array(self.force_N_m, dtype=np.float64) * chain(structure).element_length
        return np.tile(each, (structure.elements, 1)), np.zeros(3)


Load = DeadTipForce | SineTipForce | DistributedForce


def static_forces(structure: Structure, load: Load | None) -> tuple[Array, Array]:
    """Forces on the centres (N, 3) and the tip (3,) [N] of a load that is constant while it acts."""
    if load is None:
        return np.zeros((structure.elements, 3)), np.zeros(3)
    if load.history.frequency_rad_s != 0.0 or load.history.phase_rad == 0.0:
        raise ValueError(f"{load} changes with time: it has no static equilibrium")
    return load.forces(structure)


def _check_vector(name: str, vector: Vector) -> None:
    if len(vector) != 3 or not all(math.isfinite(component) for component in vector):
        raise ValueError(f"{name}: {vector} is not three finite components (x, y, z)")
