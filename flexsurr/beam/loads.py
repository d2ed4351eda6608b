"""Loads on the beam: what acts where, and when.

All forces are dead (they keep their direction) and given in the clamp's frame before it is turned; a
couple turns with the element that it twists. A load of a fixed shape follows one history:
sin(ω t + phase) from its start to its end, nothing outside.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from flexsurr.beam.chain import chain
from flexsurr.config.structure import Structure, check_within_span
from flexsurr.simulation.rhs import Array

Vector = tuple[float, float, float]


class Forces(NamedTuple):
    """What a load exerts at a factor of 1, all on the elastic axis."""

    on_centres: Array  # (N, 3) forces on the elements' centres [N]
    on_tip: Array  # (3,) force on the tip [N]
    couples: Array  # (N,) about each element's own x axis [N m]


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

    def forces(self, structure: Structure) -> Forces:
        """All of it on the tip."""
        return _at_the_tip(structure, np.array(self.force_N, dtype=np.float64))


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

    def forces(self, structure: Structure) -> Forces:
        """All of it on the tip."""
        direction = np.array(self.direction, dtype=np.float64)
        return _at_the_tip(structure, self.amplitude_N * direction / math.hypot(*direction))


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

    def forces(self, structure: Structure) -> Forces:
        """The same on every element's centre."""
        each = np.array(self.force_N_m, dtype=np.float64) * chain(structure).element_length
        return Forces(np.tile(each, (structure.elements, 1)), np.zeros(3), np.zeros(structure.elements))


Shape = Literal["uniform", "linear", "elliptic"]

# ∫ of each shape from the clamp to ξ = x/L, over L. linear: 0 at the clamp, 1 at the tip; elliptic: the
# other way round, √(1 − ξ²).
_INTEGRALS: dict[Shape, Callable[[Array], Array]] = {
    "uniform": lambda xi: xi,
    "linear": lambda xi: 0.5 * xi**2,
    "elliptic": lambda xi: 0.5 * (xi * np.sqrt(1.0 - xi**2) + np.arcsin(xi)),
}


@dataclass(frozen=True)
class SineDistributedLoad:
    """Force along z and twisting couple per length, both times shape(x) sin(ω t), from start to end.

    It acts on the part of the span from `from_m` to `to_m` (the tip, if none is given). Each element receives
    the integral over its own span (eqs. 13 and 14): a dead force at its centre on the elastic axis, and a
    couple about its own x axis.
    """

    force_N_m: float
    couple_N_m_m: float
    frequency_rad_s: float
    shape: Shape = "uniform"
    from_m: float = 0.0
    to_m: float | None = None
    start_s: float = 0.0
    end_s: float = math.inf

    def __post_init__(self) -> None:
        for name in ("force_N_m", "couple_N_m_m"):
            if not math.isfinite(getattr(self, name)):
                raise ValueError(f"{name}: {getattr(self, name)} is not finite")
        if self.shape not in _INTEGRALS:
            raise ValueError(f"shape: {self.shape!r} is not one of {', '.join(_INTEGRALS)}")
        _ = self.history

    @property
    def history(self) -> History:
        """A sine from start to end."""
        return History(self.start_s, self.end_s, self.frequency_rad_s, 0.0)

    def forces(self, structure: Structure) -> Forces:
        """The integrals over the elements; ValueError for a part outside the structure's span."""
        span = structure.length_m
        to_m = span if self.to_m is None else self.to_m
        check_within_span(self.from_m, to_m, span)
        ends = np.clip(np.linspace(0.0, span, structure.elements + 1), self.from_m, to_m) / span
        lengths = span * np.diff(_INTEGRALS[self.shape](ends))
        up = np.array([0.0, 0.0, self.force_N_m])
        return Forces(lengths[:, None] * up, np.zeros(3), self.couple_N_m_m * lengths)


Load = DeadTipForce | SineTipForce | DistributedForce | SineDistributedLoad


def static_forces(structure: Structure, load: Load | None) -> Forces:
    """The forces of a load that is constant while it acts; ValueError for any other."""
    if load is None:
        return _at_the_tip(structure, np.zeros(3))
    if load.history.frequency_rad_s != 0.0 or load.history.phase_rad == 0.0:
        raise ValueError(f"{load} changes with time: it has no static equilibrium")
    return load.forces(structure)


def _at_the_tip(structure: Structure, force: Array) -> Forces:
    return Forces(np.zeros((structure.elements, 3)), force, np.zeros(structure.elements))


def _check_vector(name: str, vector: Vector) -> None:
    if len(vector) != 3 or not all(math.isfinite(component) for component in vector):
        raise ValueError(f"{name}: {vector} is not three finite components (x, y, z)")
