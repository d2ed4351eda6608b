"""The dynamics as the equations read: loops over elements and joints, Jacobians by complex step.

The baseline of cost: plain Python and NumPy, one column of the Jacobian after the other, in all n
joint coordinates and only then projected onto the modes. The gyroscopic term, which the study drops,
is a derivative with respect to the model's own coordinates.
"""

import numpy as np

from flexsurr.beam.chain import chain
from flexsurr.beam.dynamics import BeamModel
from flexsurr.beam.kinematics import cross
from flexsurr.config.structure import Joint, Structure
from flexsurr.simulation.rhs import Array

_STEP = 1e-30
AXIS: dict[Joint, tuple[int, float]] = {"in_plane": (2, 1.0), "out_of_plane": (1, -1.0), "torsion": (0, 1.0)}
"""The column of the frame about which a joint turns, and its sense."""


def joint_rotation(joint: Joint, angle: complex) -> Array:
    """(3, 3) rotation of one joint, positive as `kinematics` has it."""
    c, s = np.cos(angle), np.sin(angle)
    if joint == "in_plane":
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    if joint == "out_of_plane":
        return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def points(structure: Structure, q: Array) -> tuple[list[Array], list[Array], Array]:
    """Positions (3,) of the masses, of the elements' centres, and of the tip at q (n,), eq. 1 [m]."""
    beam = chain(structure)
    blocks = dict(zip(structure.ordered_joints, np.split(q, len(structure.joints)), strict=True))
    frame = beam.clamp
    node = np.zeros(3)
    masses, centres = [], []
    for i in range(structure.elements):
        stretch = 0.0
        for joint, block in blocks.items():
            if joint == "axial":
                stretch = block[i]
            else:
                frame = frame @ joint_rotation(joint, block[i])
        x_axis, y_axis = frame[:, 0], frame[:, 1]
        centre = node + (0.5 * beam.element_length + stretch) * x_axis
        masses.append(centre + beam.offset * y_axis)
        centres.append(centre)
        node = node + (beam.element_length + stretch) * x_axis
    return masses, centres, node


def jacobians(structure: Structure, q: Array) -> tuple[Array, Array, Array]:
    """∂r/∂q of masses (N, 3, n), centres (N, 3, n) and tip (3, n), a complex step a column: J of eq. 3."""
    n = len(q)
    of_masses, of_centres = np.empty((2, structure.elements, 3, n))
    of_tip = np.empty((3, n))
    for k in range(n):
        step = np.zeros(n, dtype=complex)
        step[k] = 1j * _STEP
        masses, centres, tip = points(structure, q + step)
        of_masses[:, :, k] = np.array(masses).imag / _STEP
        of_centres[:, :, k] = np.array(centres).imag / _STEP
        of_tip[:, k] = tip.imag / _STEP
    return of_masses, of_centres, of_tip


def mass_matrix(structure: Structure, jacobian: Array, inertia: Array) -> Array:
    """M (n, n) = Σ m JᵀJ + I from the masses' Jacobian (N, 3, n) and the rotary inertia (n, n), eq. 3."""
    total = inertia.copy()
    for columns in jacobian:
        total += chain(structure).element_mass * columns.T @ columns
    return total


def velocities(structure: Structure, q: Array, rates: Array) -> list[Array]:
    """Velocities (3,) of the masses at q (n,) and q̇ (n,) [m/s], from element to element: eq. 1 in time."""
    beam = chain(structure)
    joints = structure.ordered_joints
    blocks = dict(zip(joints, np.split(q, len(joints)), strict=True))
    rate_blocks = dict(zip(joints, np.split(rates, len(joints)), strict=True))
    frame, turning, node_velocity = beam.clamp, np.zeros(3), np.zeros(3)
    found = []
    for i in range(structure.elements):
        stretch, stretching = 0.0, 0.0
        for joint in joints:
            if joint == "axial":
                stretch, stretching = blocks[joint][i], rate_blocks[joint][i]
            else:
                column, sense = AXIS[joint]
                turning = turning + sense * rate_blocks[joint][i] * frame[:, column]
                frame = frame @ joint_rotation(joint, blocks[joint][i])
        x_axis, y_axis = frame[:, 0], frame[:, 1]
        to_mass = (0.5 * beam.element_length + stretch) * x_axis + beam.offset * y_axis
        to_node = (beam.element_length + stretch) * x_axis
        found.append(node_velocity + cross(turning, to_mass) + stretching * x_axis)
        node_velocity = node_velocity + cross(turning, to_node) + stretching * x_axis
    return found


def gyroscopic_forces(structure: Structure, q: Array, rates: Array, modes: Array) -> Array:
    """½ ∂/∂η (q̇ᵀ M q̇) (r,) with q = Φ η at fixed q̇: complex steps of the kinetic energy (eqs. 3, 6).

    `modes` (n, r) is Φ; one step a coordinate of the model.
    """
    forces = np.empty(modes.shape[1])
    for k, mode in enumerate(modes.T):
        squares = [v @ v for v in velocities(structure, q + 1j * _STEP * mode, rates)]
        kinetic = 0.5 * chain(structure).element_mass * np.sum(squares)
        forces[k] = kinetic.imag / _STEP
    return forces


class DescribedBeam(BeamModel):
    """The right-hand side from the functions of this file."""

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at states x (2r,)."""
        structure, modes = self.projection.structure, self.projection.modes
        r = self.projection.coordinates
        eta, momenta = x[:r], x[r:]
        q = modes @ eta
        jacobian, _, _ = jacobians(structure, q)
        mass = modes.T @ mass_matrix(structure, jacobian, self.joint_inertia) @ modes
        rates = np.linalg.solve(mass, momenta)
        forces = -self.projection.stiffness @ eta - self.projection.damping @ rates
        if structure.gravity_m_s2 > 0.0:
            beam = chain(structure)
            for columns in jacobian:
                forces = forces + modes.T @ (columns.T @ (beam.element_mass * beam.gravity))
        if self.variant == "hamiltonian":
            forces = forces + gyroscopic_forces(structure, q, modes @ rates, modes)
        return np.concatenate([rates, forces])
