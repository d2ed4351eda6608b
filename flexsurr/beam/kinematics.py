"""Kinematics of the chain in vectorised NumPy: positions (eq. 1), velocities, generalised forces.

Every function broadcasts over leading axes of q and takes complex q as well, for complex steps.
Element i is turned by R_i = R_clamp Π_{j≤i} B_j R_z(ψ_j) R_y'(θ_j) R_x(φ_j), or by one rotation vector
(φ, −θ, ψ) in place of the three; B is the fixed turn of a curved axis. Then its stretch s_i moves it along
its own axis.
"""

from dataclasses import dataclass

import numpy as np

from flexsurr.beam.chain import Chain, chain, check_coordinates, rotary_inertia
from flexsurr.beam.rotation_vector import rotation
from flexsurr.config.structure import Structure
from flexsurr.simulation.rhs import Array


@dataclass(frozen=True, eq=False)
class Configuration:
    """The chain at one q (or many, along leading axes), in the clamp's frame before it is turned [m]."""

    axes: Array  # (..., 4, N, 3) angular velocity for a unit rate of each rotation; the stretch's direction
    frames: Array  # (..., N, 3, 3) orientation of the elements; columns are their axes
    nodes: Array  # (..., N + 1, 3) ends of the elements, the clamp first
    centres: Array  # (..., N, 3) middle of each element on the elastic axis
    masses: Array  # (..., N, 3) the elements' centres of gravity


def configuration(beam: Chain, q: Array) -> Configuration:
    """Positions and joint axes of `beam` at q (..., n)."""
    n = beam.elements
    psi, theta, phi, stretch = np.moveaxis(all_joints(beam, q).reshape(*q.shape[:-1], 4, n), -2, 0)
    if beam.by_vector:
        turns, tangents = rotation(rotation_vectors(psi, theta, phi))
    else:
        turns = _turns(psi, theta, phi)
    frames = np.empty((*q.shape[:-1], n, 3, 3), dtype=q.dtype)
    roots = np.empty_like(frames)
    frame = np.broadcast_to(beam.clamp, (*q.shape[:-1], 3, 3)).astype(q.dtype)
    for i in range(n):
        if beam.turns is not None:
            frame = frame @ beam.turns[i]
        roots[..., i, :, :] = frame
        frame = frame @ turns[..., i, :, :]
        frames[..., i, :, :] = frame

    along, spans, middles, arms = np.moveaxis(frames @ beam.places, -1, 0)
    if beam.by_vector:
        about = frames @ tangents
        axes = np.stack([about[..., 2], -about[..., 1], about[..., 0], along], axis=-3)
    else:
        # The axis of θ is −y after ψ, which the frame of the element before turns into place.
        minus_y = roots[..., 0] * np.sin(psi)[..., None] - roots[..., 1] * np.cos(psi)[..., None]
        axes = np.stack([roots[..., 2], minus_y, frames[..., 0], along], axis=-3)

    stretching = stretch[..., None] * along
    nodes = np.zeros((*q.shape[:-1], n + 1, 3), dtype=q.dtype)
    np.cumsum(spans + stretching, axis=-2, out=nodes[..., 1:, :])
    moved_roots = nodes[..., :-1, :] + stretching
    return Configuration(axes, frames, nodes, moved_roots + middles, moved_roots + arms)


def all_joints(beam: Chain, q: Array) -> Array:
    """(..., 4 N) the coordinates q (..., n), with zeros for the joints that are not enabled."""
    joints = np.zeros((*q.shape[:-1], 4 * beam.elements), dtype=q.dtype)
    joints[..., beam.rows] = q
    return joints


def rotation_vectors(psi: Array, theta: Array, phi: Array) -> Array:
    """(..., 3) (φ, −θ, ψ): about x, about −y, about z."""
    return np.stack([phi, -theta, psi], axis=-1)


def tip_position(structure: Structure, q: Array) -> Array:
    """(..., 3) position of the free end [m] at q (..., n), eq. 1."""
    return node_positions(structure, q)[..., -1, :]


def tip_twist(structure: Structure, q: Array) -> Array:
    """(...,) twist of the last element against the clamp [rad] at q (..., n): the angle φ of its 3-2-1 turn.

    With R the turn from the unloaded element, seen along the clamp's axes, φ = atan2(R_zy, R_zz), between −π
    and π.
    """
    at = configuration(chain(structure), _floating(check_coordinates(structure, q)))
    up = tip_up(chain(structure), at)
    return np.asarray(np.arctan2(up[..., 1], up[..., 2]))


def tip_up(beam: Chain, at: Configuration) -> Array:
    """(..., 3) how the last element's axes, unloaded those of the clamp, rise along the clamp's z."""
    return np.asarray(np.swapaxes(at.frames[..., -1, :, :] @ beam.undeformed.T, -1, -2) @ beam.clamp[:, 2])


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
    turning: Array  # (..., k, N, 3) angular velocity of the elements [rad/s]
    roots: Array  # (..., k, N, 3) of the inboard end of each element [m/s]
    masses: Array  # (..., k, N, 3) of the centres of gravity [m/s]

    def combined(self, weights: Array) -> "Velocities":
        """The velocities for the sum of the sets, each times its weight (k,)."""
        spins, roots, masses = (
            np.tensordot(weights, part, 1) for part in (self.spins, self.roots, self.masses)
        )
        return Velocities(spins, np.cumsum(spins.sum(axis=0), axis=0), roots, masses)


def velocities(beam: Chain, at: Configuration, rates: Array) -> Velocities:
    """Velocities for k sets of joint rates (..., k, n): the J q̇ of eq. 3.

    With the columns of Φ as rates, `masses` holds the columns of the Jacobian J Φ.
    """
    joint_rates = all_joints(beam, rates).reshape(*rates.shape[:-1], 4, beam.elements, 1)
    about = joint_rates * at.axes[..., None, :, :, :]
    spins, stretching = about[..., :3, :, :], about[..., 3, :, :]
    turning = np.cumsum(spins.sum(axis=-3), axis=-2)
    roots = at.nodes[..., :-1, :]
    steps = cross(turning, (at.nodes[..., 1:, :] - roots)[..., None, :, :]) + stretching
    root_velocities = np.cumsum(steps, axis=-2) - steps
    of_masses = root_velocities + cross(turning, (at.masses - roots)[..., None, :, :]) + stretching
    return Velocities(spins, turning, root_velocities, of_masses)


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
    """(..., r, r) Φᵀ (Σ m JᵀJ + Σ WᵀIW) Φ for modes Φ (n, r), without the constant rotary inertia.

    W gives the elements' angular velocities, I is their own inertia where it is exact.
    """
    return mass_of(beam, at, velocities(beam, at, modes.T))


def mass_of(beam: Chain, at: Configuration, motion: Velocities) -> Array:
    """(..., r, r) of the same, from the velocities for each mode."""
    columns = _columns(beam.root_masses * motion.masses)
    mass = columns @ np.swapaxes(columns, -1, -2)
    if beam.tensors is not None:
        mass = mass + _columns(motion.turning) @ np.swapaxes(
            _columns(spin_momenta(beam, at, motion.turning)), -1, -2
        )
    return np.asarray(mass)


def spin_momenta(beam: Chain, at: Configuration, turning: Array) -> Array:
    """(..., k, N, 3) angular momenta of the elements about their centres of gravity [kg m²/s].

    For k sets of their angular velocities `turning` (..., k, N, 3); their inertia is exact.
    """
    assert beam.tensors is not None
    turned = at.frames @ beam.tensors @ np.swapaxes(at.frames, -1, -2)
    return np.asarray((turned[..., None, :, :, :] @ turning[..., None])[..., 0])


def _columns(vectors: Array) -> Array:
    return vectors.reshape(*vectors.shape[:-2], -1)


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
