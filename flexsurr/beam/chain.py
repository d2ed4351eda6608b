"""The chain of rigid elements: what a `Structure` means in masses, springs and lengths.

q holds one block per enabled joint kind, in the order in_plane, out_of_plane, torsion, axial, each
from the clamp to the tip. Kinematics are written for chains with all four joints at every element;
a joint that is not enabled stays at zero, and `Chain.rows` says where q goes among the 4 N.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from flexsurr.config.structure import JOINTS, Joint, Structure
from flexsurr.simulation.rhs import Array

AnyArray = TypeVar("AnyArray", bound=np.ndarray)


@dataclass(frozen=True, eq=False)
class Chain:
    """A clamped chain of N elements with n coordinates. Arrays are read-only.

    The frame is the clamp's before it is turned: x along the undeformed span, y left, z up.
    """

    elements: int
    element_length: float  # l [m]
    rows: NDArray[np.intp]  # (n,) places of the coordinates among the 4 N of a chain with every joint
    element_mass: float  # lumped on each element [kg]
    offset: float  # centre of gravity ahead of the elastic axis along the element's y [m]
    clamp: Array  # (3, 3) orientation of the clamp; columns are its axes
    gravity: Array  # (3,) [m/s²]
    stiffness: Array  # (n,) joint springs [N m/rad], axial [N/m]
    damping: Array  # (n,) joint dampers, β times the springs
    torsion_inertia: float  # I0 l, rotary inertia of one element about its own x axis [kg m²]

    @property
    def coordinates(self) -> int:
        """n, the length of q."""
        return len(self.rows)


@lru_cache(maxsize=64)
def chain(structure: Structure) -> Chain:
    """The chain that `structure` describes."""
    elements = structure.elements
    length = structure.length_m / elements
    joints = structure.ordered_joints
    stiffness = {joint: joint_stiffness(structure, joint) for joint in joints}
    return Chain(
        elements=elements,
        element_length=length,
        rows=_fixed(
            np.concatenate([JOINTS.index(joint) * elements + np.arange(elements) for joint in joints])
        ),
        element_mass=structure.mass_per_length_kg_m * length,
        offset=structure.centre_of_gravity_offset_m,
        clamp=_fixed(np.array(structure.clamp_axes).T.copy()),
        gravity=_fixed(np.array([0.0, 0.0, -structure.gravity_m_s2])),
        stiffness=_fixed(np.concatenate([stiffness[joint] for joint in joints])),
        damping=_fixed(np.concatenate([stiffness[joint] * structure.damping_s(joint) for joint in joints])),
        torsion_inertia=structure.torsional_inertia_per_length_kg_m * length,
    )


def joint_stiffness(structure: Structure, joint: Joint) -> Array:
    """(N,) springs of one joint kind, clamp first [N m/rad], axial [N/m].

    Between elements k = EI/l, GJ/l or EA/l. At the clamp only half an element deforms: 2 k, or in bending
    (`tip_deflection`) 6 EI L / (l (3L − l)), with which the tip deflects under a small tip load exactly as
    the continuous beam does.
    """
    section = structure.section_stiffness(joint)
    if section is None:
        raise ValueError(f"{structure.name}: the joint {joint!r} has no section stiffness")
    span = structure.length_m
    length = span / structure.elements
    springs = np.full(structure.elements, section / length)
    if joint in ("in_plane", "out_of_plane") and structure.clamp_spring == "tip_deflection":
        springs[0] = 6.0 * section * span / (length * (3.0 * span - length))
    else:
        springs[0] = 2.0 * section / length
    return springs


def stiffness_matrix(structure: Structure) -> Array:
    """K (n, n), diagonal: the springs of the joints (eq. 4)."""
    return np.diag(chain(structure).stiffness)


def damping_matrix(structure: Structure) -> Array:
    """C (n, n), Rayleigh dissipation (eq. 5): C = K β with one β [s] per joint kind."""
    return np.diag(chain(structure).damping)


def rotary_inertia(structure: Structure) -> Array:
    """I (n, n) [kg m²]: constant, in torsion only, Tᵀ diag(I0 l) T with T lower triangular ones (eq. 3).

    It counts each element's twist rate as the sum of the torsion rates up to it.
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
