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
from flexsurr.beam.kinematics import Configuration, configuration, cross, velocities
from flexsurr.beam.planar import Plane, plane
from flexsurr.simulation.rhs import Array


def gyroscopic_forces(beam: Chain, at: Configuration, rates: Array) -> Array:
    """½ ∂/∂q (q̇ᵀ M q̇) (n,) at fixed q̇ (n,): the g_j of this file's head (eq. 6)."""
    motion = velocities(beam, at, rates[None, :])
    roots, root_velocities = at.nodes[:-1], motion.roots[0]
    momenta = beam.element_mass * motion.masses[0]
    outboard = _sum_outboard(momenta)
    angular = _sum_outboard(cross(at.masses, momenta)) - cross(roots, outboard)
    spins = motion.spins[0]
    before = np.cumsum(spins.sum(axis=0), axis=0) - spins.sum(axis=0)
    carriers = np.stack([before, before + spins[0], before + spins[0] + spins[1]])
    turning = cross(angular, carriers) - cross(root_velocities, outboard)
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
        jacobian = velocities(beam, at, self._directions).masses
        columns = jacobian.reshape(r, 3 * beam.elements)
        mass = beam.element_mass * columns @ columns.T + self.rotary_inertia
        rates = np.linalg.solve(mass, momenta)
        forces = -(self.projection.stiffness @ eta) - self.projection.damping @ rates
        if beam.gravity[2] != 0.0:
            forces += beam.element_mass * jacobian.sum(axis=1) @ beam.gravity
        if self.variant == "hamiltonian":
            forces += modes.T @ gyroscopic_forces(beam, at, modes @ rates)
        return np.concatenate([rates, forces])


class VectorisedPlanarBeam(BeamModel):
    """The right-hand side for a chain in a plane."""

    @cached_property
    def _plane(self) -> Plane:
        return plane(self.projection)

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
        turning = np.einsum("aj,aj->j", normal, frame.weights)
        if self.variant == "hamiltonian":
            arms = frame.element_mass * (rates @ columns).reshape(2, -1) @ frame.levers
            turning += (slopes @ rates) * (normal[0] * arms[1] - normal[1] * arms[0])
        return np.concatenate([rates, forces + turning @ slopes])


def _sum_outboard(values: Array) -> Array:
    """Sums over the elements (N, 3) from each one to the tip."""
    return np.cumsum(values[::-1], axis=0)[::-1]
