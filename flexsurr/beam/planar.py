"""Chains that stay in a plane: one bending joint an element, everything in terms of absolute angles.

With a single bending joint the angles add up, θ = S η with S the running sums of Φ. Mass i lies at
Σ_j A_ij (cos θ_j, sin θ_j), with levers A_ij of l inboard and l/2 at the element itself. Dead forces (gravity
too) then need nothing of the chain but their moment arms, which are constant.
"""

from dataclasses import dataclass

import numpy as np

from flexsurr.beam.chain import chain
from flexsurr.beam.projection import Projection
from flexsurr.config.structure import Structure
from flexsurr.simulation.rhs import Array


@dataclass(frozen=True, eq=False)
class Plane:
    """A chain in the plane of `axes`, its first axis along the undeformed span."""

    slopes: Array  # (N, r) S: absolute angles for each η
    levers: Array  # (N, N) A [m]
    element_length: float  # [m]
    axes: Array  # (2, 3) unit vectors in the clamp's frame before it is turned
    element_mass: float  # [kg]
    weights: Array  # (2, N) of gravity: see `moment_arms` [N m]

    def moment_arms(self, on_centres: Array, on_tip: Array) -> Array:
        """(2, N) f: dead forces (N, 3), (3,) [N] turn element j by −sin θ_j f_0j + cos θ_j f_1j [N m]."""
        along = self.axes @ on_centres.T @ self.levers
        return along + self.element_length * (self.axes @ on_tip)[:, None]


def is_planar(structure: Structure) -> bool:
    """Whether the motion stays in a plane and each mass's offset stays normal to it."""
    if structure.joints == ("in_plane",):
        return structure.centre_of_gravity_offset_m == 0.0
    return structure.joints == ("out_of_plane",)


def plane(projection: Projection) -> Plane:
    """The plane of a chain for which `is_planar` holds."""
    structure = projection.structure
    beam = chain(structure)
    normal = 2 if structure.joints == ("out_of_plane",) else 1
    length = beam.element_length
    frame = Plane(
        slopes=np.cumsum(projection.modes, axis=0),
        levers=length * (np.tri(beam.elements) - 0.5 * np.eye(beam.elements)),
        element_length=length,
        axes=beam.clamp[:, [0, normal]].T.copy(),
        element_mass=beam.element_mass,
        weights=np.zeros((2, beam.elements)),
    )
    each = beam.element_mass * beam.gravity
    weights = frame.moment_arms(np.tile(each, (beam.elements, 1)), np.zeros(3))
    frame.weights[:] = weights
    return frame
