"""The dynamics as the equations read: loops over elements and joints, Jacobians by complex step.

The baseline of cost: plain Python and NumPy, one column of the Jacobian after the other, in all n
joint coordinates and only then projected onto the modes. The gyroscopic term, which the study drops,
is a derivative with respect to the model's own coordinates.
"""

from typing import NamedTuple

import numpy as np

from flexsurr.beam.chain import Chain, chain
from flexsurr.beam.clamp_rotation import Turning
from flexsurr.beam.dynamics import BeamModel
from flexsurr.beam.kinematics import cross
from flexsurr.beam.rotation_vector import rotation
from flexsurr.config.structure import Joint, Structure
from flexsurr.simulation.rhs import Array

_STEP = 1e-30
AXIS: dict[Joint, tuple[int, float]] = {"in_plane": (2, 1.0), "out_of_plane": (1, -1.0), "torsion": (0, 1.0)}
"""The column of the frame about which a joint turns, and its sense."""


class Points(NamedTuple):
    """Where the chain is: vectors in the clamp's frame before it is turned [m], and the elements' axes."""

    masses: list[Array]  # (3,) of each element's centre of gravity
    centres: list[Array]  # (3,) of each element's middle
    tip: Array  # (3,)
    frames: list[Array]  # (3, 3) of each element, columns are its axes


class Jacobians(NamedTuple):
    """∂/∂q of the same."""

    masses: Array  # (N, 3, n)
    centres: Array  # (N, 3, n)
    tip: Array  # (3, n)
    turning: Array  # (N, 3, n) angular velocity of the elements for each rate; where their inertia is exact


def joint_rotation(joint: Joint, angle: complex) -> Array:
    """(3, 3) rotation of one joint, positive as `kinematics` has it."""
    c, s = np.cos(angle), np.sin(angle)
    if joint == "in_plane":
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    if joint == "out_of_plane":
        return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def blocks_of(structure: Structure, values: Array) -> dict[Joint, Array]:
    """`values` (n,) of the coordinates, or their rates, by the kind of joint: (N,) of each."""
    return dict(zip(structure.ordered_joints, np.split(values, len(structure.joints)), strict=True))


def rotation_vector(blocks: dict[Joint, Array], i: int) -> Array:
    """(3,) the rotations of joint i as one vector: each about its axis."""
    vector = np.zeros(3, dtype=next(iter(blocks.values())).dtype)
    for joint, (column, sense) in AXIS.items():
        if joint in blocks:
            vector[column] = sense * blocks[joint][i]
    return vector


def turned(beam: Chain, frame: Array, blocks: dict[Joint, Array], i: int) -> Array:
    """(3, 3) frame of element i, from that of the element before."""
    if beam.turns is not None:
        frame = frame @ beam.turns[i]
    if beam.by_vector:
        return np.asarray(frame @ rotation(rotation_vector(blocks, i))[0])
    for joint, block in blocks.items():
        if joint != "axial":
            frame = frame @ joint_rotation(joint, block[i])
    return frame


def points(structure: Structure, q: Array) -> Points:
    """Positions and frames at q (n,), eq. 1."""
    beam = chain(structure)
    blocks = blocks_of(structure, q)
    frame = beam.clamp
    node = np.zeros(3)
    masses, centres, frames = [], [], []
    for i in range(structure.elements):
        frame = turned(beam, frame, blocks, i)
        if "axial" in blocks:
            node = node + blocks["axial"][i] * (frame @ beam.stretches[i])
        masses.append(node + frame @ beam.arms[i])
        centres.append(node + frame @ beam.middles[i])
        frames.append(frame)
        node = node + frame @ beam.spans[i]
    return Points(masses, centres, node, frames)


def jacobians(structure: Structure, q: Array) -> Jacobians:
    """All Jacobians at q (n,), a complex step a column: J of eq. 3."""
    n, exact = len(q), chain(structure).tensors is not None
    of_masses, of_centres, turning = np.zeros((3, structure.elements, 3, n))
    of_tip = np.empty((3, n))
    for k in range(n):
        step = np.zeros(n, dtype=complex)
        step[k] = 1j * _STEP
        at = points(structure, q + step)
        of_masses[:, :, k] = np.array(at.masses).imag / _STEP
        of_centres[:, :, k] = np.array(at.centres).imag / _STEP
        of_tip[:, k] = at.tip.imag / _STEP
        for i, frame in enumerate(at.frames if exact else ()):
            # the change of a frame is its angular velocity crossed with its axes
            spin = frame.imag @ frame.real.T / _STEP
            turning[i, :, k] = spin[2, 1], spin[0, 2], spin[1, 0]
    return Jacobians(of_masses, of_centres, of_tip, turning)


def mass_matrix(structure: Structure, q: Array, jacobian: Jacobians, inertia: Array) -> Array:
    """M (n, n) = Σ m JᵀJ + I, eq. 3, from the Jacobians at q (n,) and the constant rotary inertia (n, n).

    Where the elements' inertia is exact, it is counted as they are turned.
    """
    beam = chain(structure)
    total = inertia.copy()
    for mass, columns in zip(beam.masses, jacobian.masses, strict=True):
        total += mass * columns.T @ columns
    if beam.tensors is not None:
        frames = points(structure, q).frames
        for frame, tensor, turning in zip(frames, beam.tensors, jacobian.turning, strict=True):
            total += turning.T @ frame @ tensor @ frame.T @ turning
    return total


def velocities(structure: Structure, q: Array, rates: Array) -> tuple[list[Array], list[Array]]:
    """Velocities (3,) of the masses at q (n,) and q̇ (n,) [m/s], from element to element: eq. 1 in time.

    And the elements' angular velocities (3,) along their own axes [rad/s].
    """
    beam = chain(structure)
    blocks, rate_blocks = blocks_of(structure, q), blocks_of(structure, rates)
    frame, turning, node_velocity = beam.clamp, np.zeros(3), np.zeros(3)
    found, spins = [], []
    for i in range(structure.elements):
        if beam.by_vector:
            frame = turned(beam, frame, blocks, i)
            tangent = rotation(rotation_vector(blocks, i))[1]
            turning = turning + frame @ tangent @ rotation_vector(rate_blocks, i)
        else:
            if beam.turns is not None:
                frame = frame @ beam.turns[i]
            for joint, (column, sense) in AXIS.items():
                if joint in blocks:
                    turning = turning + sense * rate_blocks[joint][i] * frame[:, column]
                    frame = frame @ joint_rotation(joint, blocks[joint][i])
        stretch, stretching = 0.0, 0.0
        if "axial" in blocks:
            stretch, stretching = blocks["axial"][i], rate_blocks["axial"][i]
        along = frame @ beam.stretches[i]
        to_mass = frame @ beam.arms[i] + stretch * along
        to_node = frame @ beam.spans[i] + stretch * along
        found.append(node_velocity + cross(turning, to_mass) + stretching * along)
        node_velocity = node_velocity + cross(turning, to_node) + stretching * along
        spins.append(frame.T @ turning)
    return found, spins


def gyroscopic_forces(structure: Structure, q: Array, rates: Array, modes: Array) -> Array:
    """½ ∂/∂η (q̇ᵀ M q̇) (r,) with q = Φ η at fixed q̇: complex steps of the kinetic energy (eqs. 3, 6).

    `modes` (n, r) is Φ; one step a coordinate of the model.
    """
    beam = chain(structure)
    forces = np.empty(modes.shape[1])
    for k, mode in enumerate(modes.T):
        found, spins = velocities(structure, q + 1j * _STEP * mode, rates)
        kinetic = 0.5 * sum(mass * v @ v for mass, v in zip(beam.masses, found, strict=True))
        if beam.tensors is not None:
            kinetic += 0.5 * sum(w @ tensor @ w for tensor, w in zip(beam.tensors, spins, strict=True))
        forces[k] = kinetic.imag / _STEP
    return forces


def inertial_forces(
    structure: Structure, q: Array, rates: Array, jacobian: Jacobians, turning: Turning
) -> Array:
    """Generalised forces (n,) of a turning clamp at q (n,) and q̇ (n,): see `clamp_rotation`."""
    beam, at = chain(structure), points(structure, q)
    seen, spins = velocities(structure, q, rates)
    omega, growth = turning.velocity, turning.acceleration
    forces = np.zeros(len(q))
    for mass, place, velocity, columns in zip(beam.masses, at.masses, seen, jacobian.masses, strict=True):
        arm = turning.arm + place
        acceleration = cross(growth, arm) + cross(omega, cross(omega, arm)) + 2.0 * cross(omega, velocity)
        forces += columns.T @ (mass * (turning.tilt - acceleration))
    if beam.tensors is not None:
        bodies = zip(at.frames, beam.tensors, spins, jacobian.turning, strict=True)
        for frame, tensor, spin, columns in bodies:
            clamp = frame.T @ omega
            moment = tensor @ (frame.T @ growth - cross(spin, clamp))
            moment += cross(clamp + spin, tensor @ (clamp + spin)) - cross(spin, tensor @ spin)
            forces -= columns.T @ (frame @ moment)
    return forces


class DescribedBeam(BeamModel):
    """The right-hand side from the functions of this file."""

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at states x (2r,)."""
        structure, modes = self.projection.structure, self.projection.modes
        r = self.projection.coordinates
        eta, momenta = x[:r], x[r:]
        q = modes @ eta
        jacobian = jacobians(structure, q)
        mass = modes.T @ mass_matrix(structure, q, jacobian, self.joint_inertia) @ modes
        rates = np.linalg.solve(mass, momenta)
        forces = -self.projection.stiffness @ eta - self.projection.damping @ rates
        if structure.gravity_m_s2 > 0.0:
            beam = chain(structure)
            for mass_i, columns in zip(beam.masses, jacobian.masses, strict=True):
                forces = forces + modes.T @ (columns.T @ (mass_i * beam.gravity))
        if self.variant == "hamiltonian":
            forces = forces + gyroscopic_forces(structure, q, modes @ rates, modes)
        return np.concatenate([rates, forces])
