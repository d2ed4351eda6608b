"""The dynamics in vectorised NumPy, with tangents in the r modal directions only.

The gyroscopic term needs no second derivative. With v the velocities of the masses, joint j feels
Σ m v·J̇_j, which summed by parts is

    g_j = a_j · (L_j × Ω_j − Ṗ_j × p_j)        for a rotation about the axis a_j
    g_j = a_j · (p_j × Ω_j)                     for a stretch along it

where p_j and L_j are momentum and angular momentum about the joint of all masses from it outwards, Ω_j the
angular velocity that carries the axis, and Ṗ_j the joint's velocity. L_j counts the elements' own spin where
their inertia is exact. The three axes of a rotation vector are carried by the element itself, and move in it
besides, as its tangent T changes: that adds Ṫᵀ L_j, in the element's frame.
"""

from functools import cached_property

import numpy as np

from flexsurr.beam.chain import Chain, chain
from flexsurr.beam.dynamics import BeamModel
from flexsurr.beam.kinematics import (
    Configuration,
    Velocities,
    all_joints,
    configuration,
    cross,
    mass_of,
    rotation_vectors,
    spin_momenta,
    velocities,
)
from flexsurr.beam.planar import Plane, plane
from flexsurr.beam.rotation_vector import tangent_rate
from flexsurr.simulation.rhs import Array


def gyroscopic_forces(beam: Chain, at: Configuration, motion: Velocities, q: Array, rates: Array) -> Array:
    """½ ∂/∂q (q̇ᵀ M q̇) (n,) at q (n,) and fixed q̇ (n,), from its velocities: the g_j above (eq. 6)."""
    momenta = beam.masses[:, None] * motion.masses
    outboard = _sum_outboard(momenta)
    moments = cross(at.masses, momenta)
    if beam.tensors is not None:
        moments = moments + spin_momenta(beam, at, motion.turning[None])[0]
    angular = _sum_outboard(moments) - cross(at.nodes[:-1], outboard)
    if beam.by_vector:
        carriers = motion.turning[None]
    else:
        psi, theta, phi = motion.spins
        before = motion.turning - phi
        carriers = np.array([before - theta - psi, before - theta, before])
    turning = cross(angular, carriers) - cross(motion.roots, outboard)
    rotations = np.sum(at.axes[:3] * turning, axis=-1)
    if beam.by_vector:
        rotations = rotations + _moving_axes(beam, at, angular, q, rates)
    stretches = np.sum(at.axes[3] * cross(outboard, motion.turning), axis=-1)
    return np.concatenate([rotations.ravel(), stretches])[beam.rows]


def _moving_axes(beam: Chain, at: Configuration, angular: Array, q: Array, rates: Array) -> Array:
    """(3, N) Ṫᵀ L of ψ, θ and φ."""
    u, moving = (
        rotation_vectors(*all_joints(beam, values).reshape(4, beam.elements)[:3]) for values in (q, rates)
    )
    about = tangent_rate(u, moving) @ np.swapaxes(at.frames, -1, -2) @ angular[:, :, None]
    return np.array([about[:, 2, 0], -about[:, 1, 0], about[:, 0, 0]])


class VectorisedBeam(BeamModel):
    """The right-hand side for any joints."""

    @cached_property
    def _directions(self) -> Array:
        return np.ascontiguousarray(self.projection.modes.T)

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at states x (2r,)."""
        beam, modes = chain(self.projection.structure), self.projection.modes
        r = self.projection.coordinates
        eta, momenta = x[:r], x[r:]
        q = modes @ eta
        at = configuration(beam, q)
        tangents = velocities(beam, at, self._directions)
        mass = mass_of(beam, at, tangents) + self.rotary_inertia
        rates = np.asarray(np.linalg.solve(mass, momenta), dtype=np.float64)
        forces = -(self.projection.stiffness @ eta) - self.projection.damping @ rates
        if beam.gravity[2] != 0.0:
            forces += (beam.masses @ tangents.masses) @ beam.gravity
        if self.variant == "hamiltonian":
            motion = tangents.combined(rates)
            forces += modes.T @ gyroscopic_forces(beam, at, motion, q, modes @ rates)
        return np.concatenate([rates, forces])


class VectorisedPlanarBeam(BeamModel):
    """The right-hand side for a chain in a plane."""

    @cached_property
    def _plane(self) -> Plane:
        return plane(self.projection)

    @cached_property
    def _heavy(self) -> bool:
        return bool(np.any(self._plane.weights))

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at states x (2r,)."""
        frame, r = self._plane, self.projection.coordinates
        eta, momenta = x[:r], x[r:]
        slopes = frame.slopes
        angles = slopes @ eta
        normal = np.array([-np.sin(angles), np.cos(angles)])
        jacobian = (slopes.T[:, None, :] * normal) @ frame.levers.T
        columns = jacobian.reshape(r, -1)
        weighted = columns * np.tile(frame.masses, 2)
        mass = weighted @ columns.T + frame.rotary_inertia
        rates = momenta / mass[0] if r == 1 else np.linalg.solve(mass, momenta)
        forces = -(self.projection.stiffness @ eta) - self.projection.damping @ rates
        if self._heavy:
            forces += (normal[0] * frame.weights[0] + normal[1] * frame.weights[1]) @ slopes
        if self.variant == "hamiltonian":
            arms = (rates @ weighted).reshape(2, -1) @ frame.levers
            forces += ((slopes @ rates) * (normal[0] * arms[1] - normal[1] * arms[0])) @ slopes
        return np.concatenate([rates, forces])


def _sum_outboard(values: Array) -> Array:
    """Sums over the elements (N, 3) from each one to the tip."""
    return np.cumsum(values[::-1], axis=0)[::-1]
