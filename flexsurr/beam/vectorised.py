"""The dynamics in vectorised NumPy, with tangents in the r modal directions only.

The gyroscopic term needs no second derivative. With v the velocities of the masses, joint j feels
Σ m v·J̇_j, which summed by parts is

    g_j = a_j · (L_j × Ω_j − Ṗ_j × p_j)        for a rotation about the axis a_j
    g_j = a_j · (p_j × Ω_j)                     for a stretch along it

where p_j and L_j are momentum and angular momentum about the joint of all masses from it outwards, Ω_j the
angular velocity that carries the axis, and Ṗ_j the joint's velocity.
"""

from functools import cached_property

import numpy as np

from flexsurr.beam.chain import Chain, chain
from flexsurr.beam.dynamics import BeamModel
from flexsurr.beam.kinematics import Configuration, Velocities, configuration, cross, velocities
from flexsurr.beam.planar import Plane, plane
from flexsurr.simulation.rhs import Array


def gyroscopic_forces(beam: Chain, at: Configuration, motion: Velocities) -> Array:
    """½ ∂/∂q (q̇ᵀ M q̇) (n,) at fixed q̇, from the velocities it gives: the g_j of this file's head (eq. 6)."""
    momenta = beam.element_mass * motion.masses
    outboard = _sum_outboard(momenta)
    angular = _sum_outboard(cross(at.masses, momenta)) - cross(at.nodes[:-1], outboard)
    psi, theta, phi = motion.spins
    inboard = np.cumsum(psi + theta + phi, axis=0)
    carriers = np.array([inboard - psi - theta - phi, inboard - theta - phi, inboard - phi])
    turning = cross(angular, carriers) - cross(motion.roots, outboard)
    joints = np.concatenate(
        [
            np.sum(at.axes[:3] * turning, axis=-1).ravel(),
            np.sum(at.axes[3] * cross(outboard, carriers[2]), axis=-1),
        ]
    )
    return joints[beam.rows]


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
        at = configuration(beam, modes @ eta)
        tangents = velocities(beam, at, self._directions)
        columns = tangents.masses.reshape(r, 3 * beam.elements)
        mass = beam.element_mass * (columns @ columns.T) + self.rotary_inertia
        rates = np.asarray(np.linalg.solve(mass, momenta), dtype=np.float64)
        forces = -(self.projection.stiffness @ eta) - self.projection.damping @ rates
        if beam.gravity[2] != 0.0:
            forces += beam.element_mass * tangents.masses.sum(axis=1) @ beam.gravity
        if self.variant == "hamiltonian":
            forces += modes.T @ gyroscopic_forces(beam, at, tangents.combined(rates))
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
        mass = frame.element_mass * columns @ columns.T
        # Without torsion there is no rotary inertia.
        rates = momenta / mass[0] if r == 1 else np.linalg.solve(mass, momenta)
        forces = -(self.projection.stiffness @ eta) - self.projection.damping @ rates
        if self._heavy:
            forces += (normal[0] * frame.weights[0] + normal[1] * frame.weights[1]) @ slopes
        if self.variant == "hamiltonian":
            arms = frame.element_mass * (rates @ columns).reshape(2, -1) @ frame.levers
            forces += ((slopes @ rates) * (normal[0] * arms[1] - normal[1] * arms[0])) @ slopes
        return np.concatenate([rates, forces])


def _sum_outboard(values: Array) -> Array:
    """Sums over the elements (N, 3) from each one to the tip."""
    return np.cumsum(values[::-1], axis=0)[::-1]
