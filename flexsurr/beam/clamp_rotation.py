"""What a chain feels as its clamp turns about an axis fixed in space: seen from the clamp, inertia.

With r from the axis, v the velocity seen from the clamp, ω the clamp's angular velocity, a mass feels

    −m (ω̇ × r + ω × (ω × r) + 2 ω × v)                                  Euler's, centrifugal, Coriolis' force

and an element with inertia I of its own, which turns at w against the clamp, in its own axes

    −(I (ω̇ − w × ω) + (ω + w) × I (ω + w) − w × I w)                    as Euler's equations have it.

Gravity keeps its direction in space, so that seen from the clamp it turns back.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flexsurr.beam.chain import Chain, chain
from flexsurr.beam.kinematics import Configuration, Velocities, cross
from flexsurr.config.history import Constant
from flexsurr.config.load import ClampRotation, Single
from flexsurr.config.structure import Structure
from flexsurr.simulation.history import History, end_s, factor, integral, slope, start_s
from flexsurr.simulation.rhs import Array

_STANDSTILL = 1e-9  # of a history's factor


class Turning(NamedTuple):
    """How the clamp turns at one instant, in its own frame before it is turned."""

    velocity: Array  # (3,) ω [rad/s]
    acceleration: Array  # (3,) ω̇ [rad/s²]
    arm: Array  # (3,) from the axis to the clamp [m]
    tilt: Array  # (3,) gravity as it is seen from the clamp, less what it was at first [m/s²]

    def exerted(self, beam: Chain, at: Configuration, motion: Velocities | None) -> tuple[Array, Array]:
        """(..., N, 3) forces on the masses [N] and moments on the elements [N m]; no `motion`: at rest."""
        places = at.masses + self.arm
        of_rates = cross(self.velocity, places)
        if motion is not None:
            of_rates = of_rates + 2.0 * motion.masses
        felt = self.tilt - cross(self.acceleration, places) - cross(self.velocity, of_rates)
        forces = beam.masses[:, None] * felt
        if beam.tensors is None:
            return forces, np.zeros_like(forces)
        own = np.swapaxes(at.frames, -1, -2)
        turns = np.zeros_like(at.masses) if motion is None else motion.turning
        velocity, acceleration, spin = (
            (own @ vector[..., None])[..., 0] for vector in (self.velocity, self.acceleration, turns)
        )
        whole = velocity + spin
        momenta = ((beam.tensors @ vector[..., None])[..., 0] for vector in (whole, spin))
        carried, alone = momenta
        moments = (beam.tensors @ (acceleration - cross(spin, velocity))[..., None])[..., 0]
        moments = moments + cross(whole, carried) - cross(spin, alone)
        return forces, -(at.frames @ moments[..., None])[..., 0]

    @property
    def steady(self) -> "Turning":
        """The same rate, held."""
        return self._replace(acceleration=np.zeros(3))


@dataclass(frozen=True, eq=False)
class TurningClamp:
    """The motion of a clamp in time."""

    axis: Array  # (3,) unit vector, in the clamp's frame before it is turned
    rate_rad_s: float
    arm: Array  # (3,) from the axis to the clamp [m]
    gravity: Array  # (3,) at the beginning [m/s²]
    history: History

    @property
    def tilts(self) -> bool:
        """Whether gravity turns, seen from the clamp."""
        return bool(np.any(np.cross(self.axis, self.gravity)))

    def at(self, t: float) -> Turning:
        """How it turns at time t [s]."""
        tilt = np.zeros(3)
        if self.tilts:
            angle = self.rate_rad_s * integral(self.history, t)
            across = np.cross(self.axis, self.gravity)
            tilt = (math.cos(angle) - 1.0) * np.cross(across, self.axis) - math.sin(angle) * across
        rate = self.rate_rad_s * self.axis
        return Turning(factor(self.history, t) * rate, slope(self.history, t) * rate, self.arm, tilt)

    def held(self, at_s: float | None) -> Turning:
        """The clamp as it turns at `at_s` [s], its rate held.

        ValueError for a rate that changes, or gravity that turns, where no instant is given.
        """
        if at_s is None and (self.tilts or not isinstance(self.history, Constant)):
            what = "gravity turns, seen from the clamp" if self.tilts else "the clamp's rate changes"
            raise ValueError(f"{what}: it has no static equilibrium")
        return self.at(start_s(self.history) if at_s is None else at_s).steady


def turning_clamp(structure: Structure, loads: Sequence[Single]) -> TurningClamp | None:
    """How the clamp turns under these loads, if it does.

    ValueError for a rate that jumps after t = 0, and for a structure with constant rotary inertia.
    """
    rotation = next((load for load in loads if isinstance(load, ClampRotation)), None)
    if rotation is None:
        return None
    beam = chain(structure)
    if "torsion" in structure.joints and beam.torsion_inertia.any():
        raise ValueError(
            "clamp_rotation: rotary_inertia is constant, which a turning clamp does not turn; allowed: exact"
        )
    jump = _jump_s(rotation.history)
    if jump is not None:
        raise ValueError(
            f"clamp_rotation: history: the clamp's rate jumps at {jump:g} s; allowed: a history that is 0 "
            "there, or has no start_s or end_s"
        )
    axis = np.array(rotation.direction) / math.hypot(*rotation.direction)
    return TurningClamp(axis, rotation.rate_rad_s, np.array(rotation.arm_m), beam.gravity, rotation.history)


def _jump_s(history: History) -> float | None:
    """When the factor jumps [s], if it does after t = 0."""
    begins, ends = start_s(history), end_s(history)
    if begins > 0.0 and abs(factor(history, begins)) > _STANDSTILL:
        return begins
    if math.isfinite(ends) and abs(factor(history, math.nextafter(ends, 0.0))) > _STANDSTILL:
        return ends
    return None
