"""Kinematics of the chain in vectorised NumPy: positions (eq. 1), velocities, generalised forces.

Every function broadcasts over leading axes of q and takes complex q as well, for complex steps.
Element i is turned by R_i = R_clamp Π_{j≤i} R_z(ψ_j) R_y'(θ_j) R_x(φ_j); then its stretch s_i moves
it along its own x axis.
"""

from dataclasses import dataclass

import numpy as np

from flexsurr.beam.chain import Chain, chain, check_coordinates, rotary_inertia
from flexsurr.config.structure import Structure
from flexsurr.simulation.rhs import Array


@dataclass(frozen=True, eq=False)
class Configuration:
    """The chain at one q (or many, along leading axes), in the clamp's frame before it is turned [m]."""

    axes: Array  # (..., 4, N, 3) axis of each joint: rotations about it, the stretch along it
    frames: Array  # (..., N, 3, 3) orientation of the elements; columns are their axes
    nodes: Array  # (..., N + 1, 3) ends of the elements, the clamp first
    centres: Array  # (..., N, 3) middle of each element on the elastic axis
    masses: Array  # (..., N, 3) the lumped masses


def configuration(beam: Chain, q: Array) -> Configuration:
    """Positions and joint axes of `beam` at q (..., n)."""
    n = beam.elements
    joints = np.zeros((*q.shape[:-1], 4 * n), dtype=q.dtype)
    joints[..., beam.rows] = q
    psi, theta, phi, stretch = (joints[..., k * n : (k + 1) * n] for k in range(4))

    turns = _turns(psi, theta, phi)
    frames = np.empty((*q.shape[:-1], n, 3, 3), dtype=q.dtype)
    roots = np.empty_like(frames)
    frame = np.broadcast_to(beam.clamp, (*q.shape[:-1], 3, 3)).astype(q.dtype)
    for i in range(n):
        roots[..., i, :, :] = frame
        frame = frame @ turns[..., i, :, :]
        frames[..., i, :, :] = frame

    x, y = frames[..., 0], frames[..., 1]
    # The axis of θ is −y after ψ, which the frame of the element before turns into place.
    minus_y = roots[..., 0] * np.sin(psi)[..., None] - roots[..., 1] * np.cos(psi)[..., None]
    axes = np.stack([roots[..., 2], minus_y, x, x], axis=-3)

    nodes = np.zeros((*q.shape[:-1], n + 1, 3), dtype=q.dtype)
    np.cumsum((beam.element_length + stretch)[..., None] * x, axis=-2, out=nodes[..., 1:, :])
    centres = nodes[..., :-1, :] + (0.5 * beam.element_length + stretch)[..., None] * x
    return Configuration(axes, frames, nodes, centres, centres + beam.offset * y)


def tip_position(structure: Structure, q: Array) -> Array:
    """(..., 3) position of the free end [m] at q (..., n), eq. 1."""
    return node_positions(structure, q)[..., -1, :]


def tip_twist(structure: Structure, q: Array) -> Array:
    """(...,) twist of the last element against the clamp [rad] at q (..., n): the angle φ of its 3-2-1 turn.

    With R the turn from the clamp's axes to the element's, φ = atan2(R_zy, R_zz), between −π and π.
    """
    tip = configuration(chain(structure), _floating(check_coordinates(structure, q))).frames[..., -1, :, :]
    up = tip.swapaxes(-1, -2) @ chain(structure).clamp[:, 2]
    return np.asarray(np.arctan2(up[..., 1], up[..., 2]))


def node_positions(structure: Structure, q: Array) -> Array:
    """(..., N + 1, 3) ends of the elements on the elastic axis [m], the clamp first, at q (..., n)."""
    return configuration(chain(structure), _floating(check_coordinates(structure, q))).nodes


def element_frames(structure: Structure, q: Array) -> Array:
    """(..., N, 3, 3) orientations of the elements at q (..., n); columns are their x, y, z axes."""
    return configuration(chain(structure), _floating(check_coordinates(structure, q))).frames


@dataclass(frozen=True, eq=False)
class Velocities:
    """Velocities of the chain for k sets of joint rates."""

    spins: Array  # (..., k, 3, N, 3) angular velocity that each rotation adds [rad/s]
    roots: Array  # (..., k, N, 3) of the inboard end of each element [m/s]
    masses: Array  # (..., k, N, 3) of the lumped masses [m/s]

    def combined(self, weights: Array) -> "Velocities":
        """The velocities for the sum of the sets, each times its weight (k,)."""
        parts = (self.spins, self.roots, self.masses)
        return Velocities(*(np.tensordot(weights, part, 1) for part in parts))


def velocities(beam: Chain, at: Configuration, rates: Array) -> Velocities:
    """Velocities for k sets of joint rates (..., k, n): the J q̇ of eq. 3.

    With the columns of Φ as rates, `masses` holds the columns of the Jacobian J Φ.
    """
    n = beam.elements
    joint_rates = np.zeros((*rates.shape[:-1], 4 * n), dtype=rates.dtype)
    joint_rates[..., beam.rows] = rates
    about = joint_rates.reshape(*rates.shape[:-1], 4, n, 1) * at.axes[..., None, :, :, :]
    spins, stretching = about[..., :3, :, :], about[..., 3, :, :]
    turning = np.cumsum(spins.sum(axis=-3), axis=-2)
    roots = at.nodes[..., :-1, :]
    steps = cross(turning, (at.nodes[..., 1:, :] - roots)[..., None, :, :]) + stretching
    root_velocities = np.cumsum(steps, axis=-2) - steps
    of_masses = root_velocities + cross(turning, (at.masses - roots)[..., None, :, :]) + stretching
    return Velocities(spins, root_velocities, of_masses)


def generalised_forces(
    beam: Chain, at: Configuration, on_masses: Array, on_centres: Array, on_tip: Array
) -> Array:
    """(..., n) Q = Jᵀ F of forces on the masses (N, 3), on the elements' centres (N, 3), on the tip (3,) [N].

    A rotation feels the moment about its joint of all that acts from its element outwards, a stretch the sum
    of the forces along the element.
    """
    forces = on_masses + on_centres
    moments = cross(at.masses, on_masses) + cross(at.centres, on_centres)
    outboard_force = np.cumsum(forces[..., ::-1, :], axis=-2)[..., ::-1, :] + on_tip
    outboard_moment = np.cumsum(moments[..., ::-1, :], axis=-2)[..., ::-1, :]
    outboard_moment = outboard_moment + cross(at.nodes[..., -1:, :], on_tip)
    about_joint = outboard_moment - cross(at.nodes[..., :-1, :], outboard_force)
    rotations = np.sum(at.axes[..., :3, :, :] * about_joint[..., None, :, :], axis=-1)
    stretches = np.sum(at.axes[..., 3:, :, :] * outboard_force[..., None, :, :], axis=-1)
    joints = np.concatenate([rotations, stretches], axis=-2)
    return joints.reshape(*joints.shape[:-2], 4 * beam.elements)[..., beam.rows]


def mass_matrix(structure: Structure, q: Array) -> Array:
    """(..., n, n) M(q) = Σ m JᵀJ + I, the kinetic energy being ½ q̇ᵀ M q̇ (eq. 3)."""
    beam = chain(structure)
    at = configuration(beam, _floating(check_coordinates(structure, q)))
    return projected_mass(beam, at, np.eye(beam.coordinates)) + rotary_inertia(structure)


def projected_mass(beam: Chain, at: Configuration, modes: Array) -> Array:
    """(..., r, r) Φᵀ (Σ m JᵀJ) Φ for modes Φ (n, r), without the rotary inertia."""
    jacobian = velocities(beam, at, modes.T).masses
    columns = jacobian.reshape(*jacobian.shape[:-2], 3 * beam.elements)
    return beam.element_mass * columns @ np.swapaxes(columns, -1, -2)


def cross(a: Array, b: Array) -> Array:
    """Cross product a × b along the last axis; several times as fast as `np.cross` on short arrays."""
    return a[..., _YZX] * b[..., _ZXY] - a[..., _ZXY] * b[..., _YZX]


_YZX, _ZXY = np.array([1, 2, 0]), np.array([2, 0, 1])


def _turns(psi: Array, theta: Array, phi: Array) -> Array:
    """(..., N, 3, 3) R_z(ψ) R_y'(θ) R_x(φ), multiplied out."""
    cz, sz, cy, sy = np.cos(psi), np.sin(psi), np.cos(theta), np.sin(theta)
    cx, sx = np.cos(phi), np.sin(phi)
    turns = np.empty((*psi.shape, 3, 3), dtype=psi.dtype)
    turns[..., 0, 0], turns[..., 1, 0], turns[..., 2, 0] = cz * cy, sz * cy, sy
    turns[..., 0, 1], turns[..., 0, 2] = -sz * cx - cz * sy * sx, sz * sx - cz * sy * cx
    turns[..., 1, 1], turns[..., 1, 2] = cz * cx - sz * sy * sx, -cz * sx - sz * sy * cx
    turns[..., 2, 1], turns[..., 2, 2] = cy * sx, cy * cx
    return turns


def _floating(q: Array) -> Array:
    return q if np.iscomplexobj(q) else q.astype(np.float64)
