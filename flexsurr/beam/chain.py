"""The chain of rigid elements: what a `Structure` means in masses, springs and lengths.

q holds one block per enabled joint kind, in the order in_plane, out_of_plane, torsion, axial, each
from the clamp to the tip. Kinematics are written for chains with all four joints at every element;
a joint that is not enabled stays at zero, and `Chain.rows` says where q goes among the 4 N.

Element i has a frame: the axes of the unloaded section at its root, which turn with it. A straight, untwisted
axis has the same one all along. Otherwise a fixed rotation leads from each frame to the next, before the
joint turns; and what is fixed to the element, the next node too, has any place in its frame.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from flexsurr.beam.span import axis_at, integral, property_at, section_axes
from flexsurr.config.along_span import FixedMass
from flexsurr.config.structure import JOINTS, STIFFNESS_KEY, Joint, Structure
from flexsurr.simulation.rhs import Array

AnyArray = TypeVar("AnyArray", bound=np.ndarray)


@dataclass(frozen=True, eq=False)
class Chain:
    """A clamped chain of N elements with n coordinates. Arrays are read-only.

    The frame is the clamp's before it is turned: x along the undeformed span, y left, z up. What belongs to
    an element is in the element's own frame, from its root.
    """

    elements: int
    element_length: float  # l [m], along the axis
    rows: NDArray[np.intp]  # (n,) places of the coordinates among the 4 N of a chain with every joint
    by_vector: bool  # whether the joints turn by a rotation vector; otherwise about z, −y, x one by one
    clamp: Array  # (3, 3) orientation of the clamp; columns are its axes
    gravity: Array  # (3,) [m/s²]
    stiffness: Array  # (n,) joint springs [N m/rad], axial [N/m]
    damping: Array  # (n,) joint dampers, β times the springs
    turns: (
        Array | None
    )  # (N, 3, 3) from the frame before to each element's own; None: an untwisted straight axis
    spans: Array  # (N, 3) to the next node [m]
    stretches: Array  # (N, 3) unit vectors along which the axial joints stretch
    middles: Array  # (N, 3) to the middle of the elastic axis, where distributed forces act [m]
    arms: Array  # (N, 3) to the centres of gravity [m]
    masses: Array  # (N,) [kg]
    tensors: Array | None  # (N, 3, 3) inertia about the centres of gravity [kg m²]; None: none, or constant
    torsion_inertia: Array  # (N,) constant rotary inertia of the elements, in torsion [kg m²]

    @property
    def coordinates(self) -> int:
        """n, the length of q."""
        return len(self.rows)

    @cached_property
    def undeformed(self) -> Array:
        """(3, 3) axes of the last element's frame in those of the clamp, unloaded."""
        axes = np.eye(3)
        for turn in () if self.turns is None else self.turns:
            axes = axes @ turn
        return axes

    @cached_property
    def root_masses(self) -> Array:
        """(N, 1) roots of the masses [kg½]."""
        return np.sqrt(self.masses)[:, None]

    @cached_property
    def places(self) -> Array:
        """(N, 3, 4) `stretches`, `spans`, `middles` and `arms` as columns, to turn them in one go."""
        return np.stack([self.stretches, self.spans, self.middles, self.arms], axis=-1)

    @cached_property
    def uniform(self) -> bool:
        """Whether all elements are alike and straight, and lumped masses that turn joint by joint."""
        alike = all(
            np.ptp(part, axis=0).max() == 0.0 for part in (self.masses, self.arms, self.torsion_inertia)
        )
        return (
            alike
            and not self.by_vector
            and self.turns is None
            and self.tensors is None
            and self.arms[0, 0] == 0.5 * self.element_length
            and self.arms[0, 2] == 0.0
            and not self.spans[:, 1:].any()
        )


@lru_cache(maxsize=64)
def chain(structure: Structure) -> Chain:
    """The chain that `structure` describes."""
    elements = structure.elements
    joints = structure.ordered_joints
    stiffness = {joint: joint_stiffness(structure, joint) for joint in joints}
    frames, turns, spans, middles = _axis(structure)
    masses, arms, inertia = _bodies(structure, frames, middles)
    exact = structure.rotary_inertia == "exact"
    lengths = np.linalg.norm(spans, axis=1, keepdims=True)
    return Chain(
        elements=elements,
        element_length=structure.length_m / elements,
        rows=_fixed(
            np.concatenate([JOINTS.index(joint) * elements + np.arange(elements) for joint in joints])
        ),
        by_vector=structure.turns_by_vector,
        clamp=_fixed(np.array(structure.clamp_axes).T.copy()),
        gravity=_fixed(np.array([0.0, 0.0, -structure.gravity_m_s2])),
        stiffness=_fixed(np.concatenate([stiffness[joint] for joint in joints])),
        damping=_fixed(np.concatenate([stiffness[joint] * structure.damping_s(joint) for joint in joints])),
        turns=None if turns is None else _fixed(turns),
        spans=_fixed(spans),
        stretches=_fixed(spans / lengths),
        middles=_fixed(middles),
        arms=_fixed(arms),
        masses=_fixed(masses),
        tensors=_fixed(inertia) if exact and inertia.any() else None,
        torsion_inertia=_fixed(np.zeros(elements) if exact else inertia[:, 0, 0].copy()),
    )


def _axis(structure: Structure) -> tuple[Array, Array | None, Array, Array]:
    """Frames (N, 3, 3) of the unloaded elements, the turns between them, and `spans` and `middles`."""
    n = structure.elements
    ends = np.linspace(0.0, structure.length_m, n + 1)
    if structure.straight:
        along = np.zeros((n, 3))
        along[:, 0] = structure.length_m / n
        return np.tile(np.eye(3), (n, 1, 1)), None, along, 0.5 * along
    points = axis_at(structure, np.linspace(0.0, structure.length_m, 2 * n + 1))
    frames = section_axes(structure, ends[:-1])
    back = np.swapaxes(frames, 1, 2)
    before = np.concatenate([np.eye(3)[None], frames[:-1]])
    roots = points[:-2:2]
    if points[0].any():
        raise ValueError(
            f"{structure.name}: elastic_axis_offset_m: {points[0][1]:g} at the clamp; allowed: 0 there"
        )
    spans, middles = ((back @ (to - roots)[:, :, None])[:, :, 0] for to in (points[2::2], points[1::2]))
    return frames, np.swapaxes(before, 1, 2) @ frames, spans, middles


def _bodies(structure: Structure, frames: Array, middles: Array) -> tuple[Array, Array, Array]:
    """Masses (N,) [kg], centres of gravity (N, 3) [m] and inertia (N, 3, 3) [kg m²] of the elements.

    Of the sections, all mass of an element lies at their common centre of gravity, and their own inertia
    turns with it. Bodies fixed to it add their place and their inertia.
    """
    n, length = structure.elements, structure.length_m
    if structure.along_span is None:
        masses = np.full(n, (structure.mass_per_length_kg_m or 0.0) * length / n)
        arms = middles + np.array([0.0, structure.centre_of_gravity_offset_m, 0.0])
        about_x, about_y = (getattr(structure, key) * length / n for key in _INERTIA)
        tensors = np.tile(np.diag([about_x, about_y, about_x - about_y]), (n, 1, 1))
    else:
        masses, arms, tensors = _sections(structure, frames)
    for body in structure.point_masses:
        i = min(int(body.at_m * n / length), n - 1)
        at, inertia = _fixed_to(structure, body, i, frames)
        masses[i], arms[i], tensors[i] = _joined(
            (masses[i], arms[i], tensors[i]), (body.mass_kg, at, inertia)
        )
    return masses, arms, tensors


_INERTIA = ("torsional_inertia_per_length_kg_m", "inertia_about_y_per_length_kg_m")


def _sections(structure: Structure, frames: Array) -> tuple[Array, Array, Array]:
    """Masses, centres of gravity and inertia of the elements, from the sections' properties."""
    ends = np.linspace(0.0, structure.length_m, structure.elements + 1)

    def mass(s: Array) -> Array:
        return property_at(structure, "mass_per_length_kg_m", s)

    def moment(s: Array) -> Array:
        aside = property_at(structure, "centre_of_gravity_offset_m", s)[:, None]
        centres = axis_at(structure, s) + aside * section_axes(structure, s)[:, :, 1]
        return np.asarray(mass(s)[:, None] * centres)

    def inertia(s: Array) -> Array:
        about_x, about_y = (property_at(structure, key, s) for key in _INERTIA)
        axes = section_axes(structure, s)
        principal = np.stack([about_x, about_y, about_x - about_y], axis=-1)
        return np.asarray((axes * principal[:, None, :]) @ np.swapaxes(axes, 1, 2))

    masses = integral(structure, mass, ends)
    back = np.swapaxes(frames, 1, 2)
    centres = integral(structure, moment, ends) / masses[:, None] - axis_at(structure, ends[:-1])
    return (
        masses,
        (back @ centres[:, :, None])[:, :, 0],
        back @ integral(structure, inertia, ends) @ frames,
    )


def _fixed_to(structure: Structure, body: FixedMass, element: int, frames: Array) -> tuple[Array, Array]:
    """Centre of gravity (3,) [m] and inertia (3, 3) [kg m²] of a body in the frame of its element."""
    root = structure.length_m / structure.elements * element
    axes = section_axes(structure, np.array([body.at_m]))[0]
    start, at = axis_at(structure, np.array([root, max(body.at_m, root)]))
    back = frames[element].T
    xy, xz, yz = body.products_of_inertia_kg_m2
    inertia = np.diag(body.inertia_kg_m2) - np.array([[0.0, xy, xz], [xy, 0.0, yz], [xz, yz, 0.0]])
    turn = back @ axes
    return back @ (at - start + axes @ np.array(body.offset_m)), turn @ inertia @ turn.T


_Body = tuple[float, Array, Array]


def _joined(one: _Body, other: _Body) -> _Body:
    """Mass, centre of gravity and inertia about it of two bodies together (Steiner)."""
    mass = one[0] + other[0]
    apart = other[1] - one[1]
    reduced = one[0] * other[0] / mass
    inertia = one[2] + other[2] + reduced * (apart @ apart * np.eye(3) - np.outer(apart, apart))
    return mass, one[1] + other[0] / mass * apart, inertia


def joint_stiffness(structure: Structure, joint: Joint) -> Array:
    """(N,) springs of one joint kind, clamp first [N m/rad], axial [N/m].

    Between elements k = EI/l, GJ/l or EA/l; where these vary, 1/k is the integral of 1/EI from the middle of
    one element to that of the next. At the clamp only half an element deforms: 2 k, or in bending
    (`tip_deflection`) 6 EI L / (l (3L − l)), with which the tip of a uniform beam deflects under a small tip
    load exactly as the continuous one does.
    """
    key, span = STIFFNESS_KEY[joint], structure.length_m
    if None in structure.values_of(key):
        raise ValueError(f"{structure.name}: the joint {joint!r} has no section stiffness")
    length = span / structure.elements
    section = structure.section_stiffness(joint)
    if len(structure.values_of(key)) == 1 and section is not None:
        springs = np.full(structure.elements, section / length)
        springs[0] *= 2.0
    else:
        middles = length * (np.arange(structure.elements) + 0.5)
        springs = 1.0 / integral(
            structure, lambda s: 1.0 / property_at(structure, key, s), np.concatenate([[0.0], middles])
        )
    if joint in ("in_plane", "out_of_plane") and structure.clamp_spring == "tip_deflection":
        springs[0] *= 3.0 * span / (3.0 * span - length)
    return springs


def stiffness_matrix(structure: Structure) -> Array:
    """K (n, n), diagonal: the springs of the joints (eq. 4)."""
    return np.diag(chain(structure).stiffness)


def damping_matrix(structure: Structure) -> Array:
    """C (n, n), Rayleigh dissipation (eq. 5): C = K β with one β [s] per joint kind."""
    return np.diag(chain(structure).damping)


def rotary_inertia(structure: Structure) -> Array:
    """I (n, n) [kg m²]: constant, in torsion only, Tᵀ diag(I0 l) T with T lower triangular ones (eq. 3).

    Zero where the inertia is exact. It counts each element's twist rate as the sum of the torsion rates up
    to it.
    """
    beam = chain(structure)
    inertia = np.zeros((4 * beam.elements, 4 * beam.elements))
    torsion = slice(JOINTS.index("torsion") * beam.elements, (JOINTS.index("torsion") + 1) * beam.elements)
    accumulate = np.tri(beam.elements)
    inertia[torsion, torsion] = beam.torsion_inertia * accumulate.T @ accumulate
    return np.ascontiguousarray(inertia[np.ix_(beam.rows, beam.rows)])


def check_coordinates(structure: Structure, q: Array, name: str = "q") -> Array:
    """`q` as an array whose last axis has the structure's n coordinates; ValueError otherwise."""
    values = np.asarray(q)
    if values.ndim == 0 or values.shape[-1] != structure.coordinates:
        raise ValueError(
            f"{name} has shape {values.shape}; {structure.name} has {structure.coordinates} coordinates"
        )
    return values


def _fixed(array: AnyArray) -> AnyArray:
    array.flags.writeable = False
    return array
