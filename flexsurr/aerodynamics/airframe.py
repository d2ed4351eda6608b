"""What the aerodynamics is of: a lattice, how its panels move with the elastic modes, body, references."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flexsurr.aerodynamics.features import MODES, ReferenceDimensions
from flexsurr.aerodynamics.horseshoe import ends_of
from flexsurr.aerodynamics.lattice import Lattice
from flexsurr.config.aircraft import Aircraft
from flexsurr.simulation.rhs import Array


@dataclass(frozen=True, eq=False)
class ModalMotion:
    """How N panels move with m ≤ 6 elastic modes, in geometry axes (x aft, y right, z up), per unit of η.

    `translation` (N, 3, m) [m / unit of η] and `rotation` (N, 3, m) [rad / unit of η] at the control
    points, `bound_translation` (N, 3, m) at the midpoints of the bound vortices. Rotations are
    right-handed about the axes. Missing modes up to six count as rigid.
    """

    translation: Array
    rotation: Array
    bound_translation: Array

    @classmethod
    def none(cls, lattice: Lattice) -> "ModalMotion":
        """A rigid airframe."""
        nothing = np.zeros((len(lattice), 3, 0))
        return cls(nothing, nothing, nothing)


@dataclass(frozen=True, eq=False)
class Airframe:
    """Everything geometric that coefficients depend on.

    `centre_of_gravity` (3,) [m] in geometry axes: moments are about it, and V is its airspeed.
    `parasite_drag_coefficient` is that at the design point. `munk_volume` [m³] is the fuselage's
    (k₂ − k₁) · volume: in potential flow it feels a pure moment 2 q̄ (k₂ − k₁) volume per radian,
    destabilising in pitch and yaw (Munk, NACA Report 184). Raises ValueError for arrays that don't fit.
    """

    lattice: Lattice
    motion: ModalMotion
    reference: ReferenceDimensions
    centre_of_gravity: tuple[float, float, float]
    parasite_drag_coefficient: float = 0.0
    munk_volume: float = 0.0

    def __post_init__(self) -> None:
        for name in ("translation", "rotation", "bound_translation"):
            shape = getattr(self.motion, name).shape
            if len(shape) != 3 or shape[:2] != (len(self.lattice), 3) or shape[2] > MODES:
                raise ValueError(
                    f"{name} has the shape {shape}; expected ({len(self.lattice)}, 3, at most {MODES})"
                )


class Panels(NamedTuple):
    """An airframe for compiled code, N panels; vectors in geometry axes, points from the centre of gravity.

    `ends` (6, N): both ends of the bound vortices. `control`, `bound` (N, 3): points. `vortex` (N, 3): the
    bound vortices themselves. `hinge` (N, 6, 3), `shift`, `turn` and `bound_shift` (N, 6, 3): axes of the
    controls, translation and rotation by the modes.
    """

    ends: Array
    control: Array
    bound: Array
    vortex: Array
    normal: Array
    hinge: Array
    shift: Array
    turn: Array
    bound_shift: Array
    area: float
    chord: float
    span: float
    parasite_drag_coefficient: float
    munk_volume: float


def panels_of(airframe: Airframe) -> Panels:
    """The compiled form of `airframe`."""
    lattice, motion = airframe.lattice, airframe.motion
    origin = np.array(airframe.centre_of_gravity)
    return Panels(
        ends=ends_of(lattice) - np.tile(origin, 2)[:, None],
        control=lattice.control - origin,
        bound=lattice.bound - origin,
        vortex=lattice.end - lattice.start,
        normal=np.ascontiguousarray(lattice.normal),
        hinge=np.ascontiguousarray(lattice.hinge),
        shift=_by_mode(motion.translation),
        turn=_by_mode(motion.rotation),
        bound_shift=_by_mode(motion.bound_translation),
        area=float(airframe.reference.area),
        chord=float(airframe.reference.chord),
        span=float(airframe.reference.span),
        parasite_drag_coefficient=float(airframe.parasite_drag_coefficient),
        munk_volume=float(airframe.munk_volume),
    )


def airframe_of(
    aircraft: Aircraft,
    lattice: Lattice,
    motion: ModalMotion,
    centre_of_gravity: tuple[float, float, float],
) -> Airframe:
    """The airframe of an aircraft file with its `lattice`; the centre of gravity [m] in geometry axes."""
    body, length = aircraft.fuselage, aircraft.published.fuselage_length_m
    volume = body.fullness * 0.25 * math.pi * body.diameter_m**2 * length
    return Airframe(
        lattice=lattice,
        motion=motion,
        reference=ReferenceDimensions(
            aircraft.reference.area_m2, aircraft.reference.chord_m, aircraft.published.wing_span_m
        ),
        centre_of_gravity=centre_of_gravity,
        parasite_drag_coefficient=aircraft.aerodynamics.parasite_drag_coefficient,
        munk_volume=volume * apparent_mass_difference(length / body.diameter_m),
    )


def apparent_mass_difference(slenderness: float) -> float:
    """k₂ − k₁ of a prolate spheroid of this length over diameter (Lamb, *Hydrodynamics*, art. 114)."""
    e = math.sqrt(1.0 - 1.0 / slenderness**2)
    logarithm = math.log((1.0 + e) / (1.0 - e))
    along = 2.0 * (1.0 - e**2) / e**3 * (0.5 * logarithm - e)
    across = 1.0 / e**2 - (1.0 - e**2) / (2.0 * e**3) * logarithm
    return across / (2.0 - across) - along / (2.0 - along)


def _by_mode(motion: Array) -> Array:
    """(N, 3, m) -> (N, MODES, 3), missing modes zero."""
    n, _, m = motion.shape
    result = np.zeros((n, MODES, 3))
    result[:, :m] = motion.transpose(0, 2, 1)
    return result
