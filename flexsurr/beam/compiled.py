"""The compiled implementation: kernels built from a projection, and the model that holds one."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from flexsurr.beam.chain import chain, rotary_inertia
from flexsurr.beam.dynamics import BeamModel
from flexsurr.beam.planar import is_planar, plane
from flexsurr.beam.planar_sweep import PlanarChain, PlanarMode, padded_length, planar_work_size
from flexsurr.beam.projection import Projection
from flexsurr.beam.spatial_sweep import SpatialChain, spatial_work_size
from flexsurr.simulation.rhs import Array, evaluate


@dataclass(frozen=True, eq=False)
class CompiledBeam(BeamModel):
    """The right-hand side as a kernel that compiled integrators step."""

    @cached_property
    def kernel(self) -> NamedTuple:
        """The cheapest kernel that fits the chain."""
        keep = self.variant == "hamiltonian"
        if not is_planar(self.projection.structure):
            return spatial_kernel(self.projection, keep)
        if self.projection.coordinates == 1:
            return planar_mode_kernel(self.projection, keep)
        return planar_kernel(self.projection, keep)

    @property
    def work_size(self) -> int:
        """Scratch that the kernel needs."""
        size = planar_work_size if is_planar(self.projection.structure) else spatial_work_size
        return size(self.projection.structure.elements, self.projection.coordinates)

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at states x (2r,)."""
        x = np.ascontiguousarray(x, dtype=np.float64)
        dx = np.empty_like(x)
        evaluate(self.kernel, float(t), x, dx, np.empty(self.work_size))
        return dx


def planar_mode_kernel(projection: Projection, gyroscopic: bool) -> PlanarMode:
    """The kernel of a single coordinate of a chain in a plane."""
    frame = plane(projection)
    slopes = padded(frame.slopes[:, 0])
    return PlanarMode(
        slopes=slopes,
        arms=frame.element_length * slopes,
        weights=own(frame.weights / frame.element_length),
        mass=frame.element_mass,
        stiffness=float(projection.stiffness[0, 0]),
        damping=float(projection.damping[0, 0]),
        gyroscopic=gyroscopic,
        heavy=bool(np.any(frame.weights)),
    )


def planar_kernel(projection: Projection, gyroscopic: bool) -> PlanarChain:
    """The kernel of any coordinates of a chain in a plane."""
    frame = plane(projection)
    return PlanarChain(
        slopes=padded(frame.slopes.T),
        element_length=frame.element_length,
        weights=own(frame.weights),
        mass=frame.element_mass,
        stiffness=own(projection.stiffness),
        damping=own(projection.damping),
        gyroscopic=gyroscopic,
    )


def spatial_kernel(projection: Projection, gyroscopic: bool) -> SpatialChain:
    """The kernel of any coordinates of any chain."""
    beam = chain(projection.structure)
    modes = all_joints(projection)
    moves = np.any(modes.reshape(-1, 4, beam.elements) != 0.0, axis=1)
    inertia = projection.modes.T @ rotary_inertia(projection.structure) @ projection.modes
    return SpatialChain(
        modes=modes,
        first=np.argmax(moves, axis=1).astype(np.int64),
        clamp=own(beam.clamp),
        element_length=beam.element_length,
        offset=beam.offset,
        mass=beam.element_mass,
        weight=own(beam.element_mass * beam.gravity),
        unloaded=np.zeros((beam.elements, 3)),
        rotary_inertia=own(inertia),
        stiffness=own(projection.stiffness),
        damping=own(projection.damping),
        gyroscopic=gyroscopic,
        heavy=bool(np.any(beam.gravity)),
    )


def all_joints(projection: Projection) -> Array:
    """(r, 4 N) Φᵀ with zero columns for the joints that are not enabled."""
    beam = chain(projection.structure)
    modes = np.zeros((projection.coordinates, 4 * beam.elements))
    modes[:, beam.rows] = projection.modes.T
    return modes


def padded(rows: Array) -> Array:
    """`rows` (..., N) with zeros up to the length P that planar kernels sweep."""
    n = rows.shape[-1]
    return np.pad(own(rows), [(0, 0)] * (rows.ndim - 1) + [(0, padded_length(n) - n)])


def own(array: Array) -> Array:
    """A contiguous, writable copy: numba compiles anew for every other kind of array."""
    return np.array(array, dtype=np.float64, order="C")
