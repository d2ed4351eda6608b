"""The compiled implementation: kernels built from a projection, and the model that holds one."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexsurr.beam.chain import Chain, chain, rotary_inertia
from flexsurr.beam.clamp_rotation import TurningClamp
from flexsurr.beam.clamp_sweep import ClampTurned
from flexsurr.beam.dynamics import BeamModel
from flexsurr.beam.planar import is_planar, plane
from flexsurr.beam.planar_sweep import PlanarChain, PlanarMode, padded_length, planar_work_size
from flexsurr.beam.projection import Projection
from flexsurr.beam.rigid_sweep import RigidChain, RigidElements, rigid_work_size
from flexsurr.beam.spatial_sweep import SpatialChain, spatial_work_size
from flexsurr.beam.tip_sweep import sweep_tips
from flexsurr.config.structure import JOINTS
from flexsurr.simulation.history import histories_kernel
from flexsurr.simulation.rhs import Array, ByKernel, rates


@dataclass(frozen=True, eq=False)
class CompiledBeam(ByKernel, BeamModel):
    """The right-hand side as a kernel that compiled integrators step."""

    @cached_property
    def kernel(self) -> NamedTuple:
        """The cheapest kernel that fits the chain."""
        keep = self.variant == "hamiltonian"
        if is_planar(self.projection.structure):
            single = self.projection.coordinates == 1
            return (planar_mode_kernel if single else planar_kernel)(self.projection, keep)
        if chain(self.projection.structure).uniform:
            return spatial_kernel(self.projection, keep)
        return rigid_kernel(self.projection, keep)

    @property
    def work_size(self) -> int:
        """Scratch that the kernel needs."""
        structure = self.projection.structure
        if is_planar(structure):
            size = planar_work_size
        else:
            size = spatial_work_size if chain(structure).uniform else rigid_work_size
        return size(structure.elements, self.projection.coordinates)

    def energy(self, x: Array) -> Array:
        """As every model's; many states of real numbers by compiled code."""
        if np.iscomplexobj(x):
            return super().energy(x)
        x = np.asarray(x, dtype=np.float64)
        r = self.projection.coordinates
        eta, momenta = x[..., :r], x[..., r:]
        states = x.reshape(-1, 2 * r)
        eta_rates = rates(self, np.zeros(len(states)), states)[:, :r].reshape(eta.shape)
        kinetic = 0.5 * np.sum(momenta * eta_rates, axis=-1)
        elastic = 0.5 * np.sum(eta * (eta @ self.projection.stiffness.T), axis=-1)
        if not np.any(chain(self.projection.structure).gravity):
            return np.asarray(kinetic + elastic)
        works = self._tips(x)[1] - self._tips(np.zeros(2 * r))[1]
        return np.asarray(kinetic + elastic - works)

    def tip(self, x: Array) -> Array:
        """As every model's; many states of real numbers by compiled code."""
        return super().tip(x) if np.iscomplexobj(x) else self._tips(np.asarray(x, dtype=np.float64))[0]

    def _tips(self, x: Array) -> tuple[Array, Array]:
        """Positions (..., 3) [m] of the tip, and Σ m g·r (...,) [J], at states x (..., 2r)."""
        beam = chain(self.projection.structure)
        states = np.ascontiguousarray(x).reshape(-1, x.shape[-1])
        tips, works = np.empty((len(states), 3)), np.empty(len(states))
        weights = own(beam.masses[:, None] * beam.gravity)
        sweep_tips(all_joints(self.projection), rigid_elements(beam), weights, states, tips, works)
        return tips.reshape(*x.shape[:-1], 3), works.reshape(x.shape[:-1])


def planar_mode_kernel(projection: Projection, gyroscopic: bool) -> PlanarMode:
    """The kernel of a single coordinate of a chain in a plane."""
    frame = plane(projection)
    slopes = frame.slopes[:, 0]
    about_roots = frame.masses @ frame.levers**2
    return PlanarMode(
        slopes=padded(slopes),
        moments=own(frame.element_length * (frame.masses @ frame.levers)),
        weights=own(frame.weights),
        inertia=float(frame.rotary_inertia[0, 0] + about_roots @ slopes**2),
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
        arms=own(frame.element_length * frame.slopes.T),
        weights=own(frame.weights),
        root_masses=own(np.sqrt(frame.masses)),
        root_arms=own(frame.element_length * np.sqrt(frame.masses)),
        places=own(np.diagonal(frame.levers) / frame.element_length),
        inertia=own(frame.rotary_inertia),
        stiffness=own(projection.stiffness),
        damping=own(projection.damping),
        gyroscopic=gyroscopic,
    )


def spatial_kernel(projection: Projection, gyroscopic: bool) -> SpatialChain:
    """The kernel of any coordinates of a uniform, straight chain."""
    beam = chain(projection.structure)
    modes = all_joints(projection)
    inertia = projection.modes.T @ rotary_inertia(projection.structure) @ projection.modes
    return SpatialChain(
        modes=modes,
        first=first_moved(modes),
        clamp=own(beam.clamp),
        element_length=beam.element_length,
        offset=float(beam.arms[0, 1]),
        mass=float(beam.masses[0]),
        weight=own(beam.masses[0] * beam.gravity),
        unloaded=np.zeros((beam.elements, 3)),
        rotary_inertia=own(inertia),
        stiffness=own(projection.stiffness),
        damping=own(projection.damping),
        gyroscopic=gyroscopic,
        heavy=bool(np.any(beam.gravity)),
    )


def rigid_kernel(projection: Projection, gyroscopic: bool) -> RigidChain:
    """The kernel of any coordinates of any chain."""
    beam = chain(projection.structure)
    modes = all_joints(projection)
    squares, axes = np.linalg.eigh(own_inertia(beam))
    roots = np.sqrt(np.maximum(squares, 0.0))[:, :, None] * np.swapaxes(axes, 1, 2)
    inertia = projection.modes.T @ rotary_inertia(projection.structure) @ projection.modes
    return RigidChain(
        modes=modes,
        first=first_moved(modes),
        elements=rigid_elements(beam),
        masses=own(beam.masses),
        root_masses=own(np.sqrt(beam.masses)),
        root_tensors=own(roots),
        weights=own(beam.masses[:, None] * beam.gravity),
        unloaded=np.zeros((beam.elements, 3)),
        rotary_inertia=own(inertia),
        stiffness=own(projection.stiffness),
        damping=own(projection.damping),
        exact=beam.tensors is not None,
        gyroscopic=gyroscopic,
        heavy=bool(np.any(beam.gravity)),
    )


def turned_kernel(model: NamedTuple, projection: Projection, clamp: TurningClamp) -> ClampTurned:
    """The kernel of a model whose clamp turns."""
    beam = chain(projection.structure)
    return ClampTurned(
        model=model,
        modes=all_joints(projection),
        elements=rigid_elements(beam),
        masses=own(beam.masses),
        tensors=own_inertia(beam),
        unloaded=np.zeros((beam.elements, 3)),
        rate=own(clamp.rate_rad_s * clamp.axis),
        axis=own(clamp.axis),
        arm=own(clamp.arm),
        gravity=own(clamp.gravity),
        history=histories_kernel([clamp.history]),
        exact=beam.tensors is not None,
        tilts=clamp.tilts,
    )


def own_inertia(beam: Chain) -> Array:
    """(N, 3, 3) inertia of the elements that turns with them [kg m²]; zeros where there is none."""
    return np.zeros((beam.elements, 3, 3)) if beam.tensors is None else own(beam.tensors)


def rigid_elements(beam: Chain) -> RigidElements:
    """The chain as compiled code has it."""
    bent = beam.turns is not None
    return RigidElements(
        clamp=own(beam.clamp),
        turns=own(np.zeros((beam.elements, 3, 3)) if beam.turns is None else beam.turns),
        spans=own(beam.spans),
        stretches=own(beam.stretches),
        middles=own(beam.middles),
        arms=own(beam.arms),
        bent=bent,
        by_vector=beam.by_vector,
        axial=bool(np.any(beam.rows >= JOINTS.index("axial") * beam.elements)),
    )


def first_moved(modes: Array) -> NDArray[np.int64]:
    """(r,) the first element that each of the modes (r, 4 N) moves."""
    moves = np.any(modes.reshape(len(modes), 4, -1) != 0.0, axis=1)
    return np.asarray(np.argmax(moves, axis=1), dtype=np.int64)


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
