"""Lattices to test with: single wings, and the airliner with few panels and modes of known motion."""

from pathlib import Path

import numpy as np

from flexsurr.aerodynamics.airframe import Airframe, ModalMotion, airframe_of
from flexsurr.aerodynamics.features import (
    ALPHA,
    ALTITUDE,
    DRAG,
    FEATURES,
    LIFT,
    MACH,
    PITCH,
    ReferenceDimensions,
)
from flexsurr.aerodynamics.lattice import Lattice, PanelCounts, airliner_lattice, panel
from flexsurr.aerodynamics.mach_grid import fixed_machs
from flexsurr.aerodynamics.vortex_lattice import frozen
from flexsurr.config.aircraft import Section, Surface, load_aircraft

AIRLINER = load_aircraft(Path(__file__).parents[2] / "config" / "aircraft" / "gnba.yaml")
FEW = PanelCounts(wing=(6, 2), horizontal_tail=(2, 2), vertical_tail=(2, 2))
CENTRE_OF_GRAVITY = (17.5, 0.0, -0.3)

# Half the width of the range that each feature is drawn from in tests of laws.
RANGES = np.array(
    [0.0, 5000.0, 0.15, 0.15, 4e-3, 4e-3, 2e-3, *[0.15] * 6, *[0.1] * 6, *[0.05] * 6],
)
MIDDLES = np.array([0.5, 5000.0, *[0.0] * 23])


def wing(
    sections: tuple[Section, ...],
    strips: int,
    chordwise: int,
    reference: ReferenceDimensions,
    moments_about: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Airframe:
    """A wing symmetric about y = 0 with its apex at the origin."""
    surface = Surface(source="assumed", root_m=(0.0, 0.0, 0.0), sections=sections, elastic_axis=(0.4,))
    right, _ = panel(surface, "wing", strips, chordwise)
    lattice = Lattice.joined([right, right.mirrored()])
    return Airframe(lattice, ModalMotion.none(lattice), reference, moments_about)


def lift_drag_moment(airframe: Airframe, alpha: float, mach: float = 0.0) -> tuple[float, float, float]:
    """C_L, induced C_D and C_m at an angle of attack [rad]."""
    u = np.zeros(len(FEATURES))
    u[MACH], u[ALTITUDE], u[ALPHA] = mach, 10000.0, alpha
    c = frozen(airframe, fixed_machs([mach]))(u)
    return c[LIFT], c[DRAG], c[PITCH]


def in_body_axes(u, c):
    """C_X, C_Y, C_Z, C_l, C_m, C_n and the rest (12,) of the coefficients `c`, by the definition of lift."""
    s, k = np.sin(u[ALPHA]), np.cos(u[ALPHA])
    lift, drag, side, pitch, roll, yaw = c[:6]
    return np.array([s * lift - k * drag, side, -k * lift - s * drag, roll, pitch, yaw, *c[6:]])


def flexible_airliner(motion_of=None, counts: PanelCounts = FEW) -> Airframe:
    """The airliner with the modes `motion_of(points)` -> translation, rotation (N, 3, m), else rigid."""
    lattice = airliner_lattice(AIRLINER, counts)
    motion = ModalMotion.none(lattice)
    if motion_of is not None:
        translation, rotation = motion_of(lattice.control)
        motion = ModalMotion(translation, rotation, motion_of(lattice.bound)[0])
    return airframe_of(AIRLINER, lattice, motion, CENTRE_OF_GRAVITY)


def symmetric_and_antisymmetric(points):
    """Three modes symmetric about y = 0 and three antisymmetric, smooth and otherwise arbitrary."""
    x, y, z = (points / 10.0).T
    zero = np.zeros(len(points))
    even = [
        ([0.1 * y**2, 0.2 * y * z, y**2], [0.3 * y * z, 0.2 * x, -0.1 * y]),
        ([0.1 * x, y * x, z], [y, 0.1 + 0.1 * x, y * x]),
        ([zero, y**3, x * z], [y * x, y**2, zero]),
    ]
    odd = [
        ([y * x, 0.3 * x, y], [0.2 + z, y, 0.3 * x]),
        ([y**3, z, 0.2 * y * x], [x, y * z, y**2]),
        ([0.1 * y, y**2, y**3], [zero, 0.1 * y, 0.2 + 0.1 * z]),
    ]
    modes = even + odd
    translation = np.stack([np.stack(t, axis=1) for t, _ in modes], axis=2)
    rotation = 0.1 * np.stack([np.stack(r, axis=1) for _, r in modes], axis=2)
    return translation, rotation


def rigid_body(points):
    """Translations along x, y, z, then rotations about the axes through the centre of gravity."""
    arms = points - np.array(CENTRE_OF_GRAVITY)
    translation = np.zeros((len(points), 3, 6))
    rotation = np.zeros((len(points), 3, 6))
    for axis in range(3):
        e = np.eye(3)[axis]
        translation[:, :, axis] = e
        translation[:, :, 3 + axis] = np.cross(e, arms)
        rotation[:, :, 3 + axis] = e
    return translation, rotation
