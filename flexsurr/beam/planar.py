"""Chains that stay in a plane: one bending joint an element, everything in terms of absolute angles.

With a single bending joint the angles add up, θ = S η with S the running sums of Φ. Mass i lies at
Σ_j A_ij (cos θ_j, sin θ_j), with levers A_ij of l inboard and its own arm at the element itself, l/2 where
the mass is spread evenly. Rotary inertia turns with the angles alone: it is constant. Dead forces (gravity
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
    middles: Array  # (N, N) the same for the elements' middles, where distributed forces act [m]
    element_length: float  # [m]
    axes: Array  # (2, 3) unit vectors in the clamp's frame before it is turned
    masses: Array  # (N,) [kg]
    rotary_inertia: Array  # (r, r) [kg m²]
    weights: Array  # (2, N) of gravity: see `moment_arms` [N m]
    own_normal: Array  # (3,) the axis about which the angles turn, in any element's own axes

    def moment_arms(self, on_centres: Array, on_tip: Array) -> Array:
        """(2, N) f: dead forces (N, 3), (3,) [N] turn element j by −sin θ_j f_0j + cos θ_j f_1j [N m]."""
        along = self.axes @ on_centres.T @ self.middles
        return along + self.element_length * (self.axes @ on_tip)[:, None]


def is_planar(structure: Structure) -> bool:
    """Whether the motion stays in a plane, and the centres of gravity on the axis or beside the plane."""
    if structure.joints not in (("in_plane",), ("out_of_plane",)) or not structure.straight:
        return False
    return not chain(structure).arms[:, _normal(structure)].any()


def plane(projection: Projection) -> Plane:
    """The plane of a chain for which `is_planar` holds."""
    structure = projection.structure
    beam = chain(structure)
    normal = _normal(structure)
    length = beam.element_length
    slopes = np.cumsum(projection.modes, axis=0)
    inboard = length * np.tri(beam.elements, k=-1)
    levers = inboard + np.diag(beam.arms[:, 0])
    axes = beam.clamp[:, [0, normal]].T.copy()
    about = 3 - normal  # the axis about which the joints turn, y or z
    inertia = np.zeros(beam.elements) if beam.tensors is None else beam.tensors[:, about, about]
    return Plane(
        slopes=slopes,
        levers=levers,
        middles=inboard + 0.5 * length * np.eye(beam.elements),
        element_length=length,
        axes=axes,
        masses=beam.masses,
        rotary_inertia=slopes.T @ (inertia[:, None] * slopes),
        weights=axes @ (beam.masses * beam.gravity[:, None]) @ levers,
        own_normal=np.array([0.0, -1.0, 0.0]) if normal == 2 else np.array([0.0, 0.0, 1.0]),
    )


def _normal(structure: Structure) -> int:
    """The axis across the beam in the plane of its motion: z, or y."""
    return 2 if structure.joints == ("out_of_plane",) else 1
