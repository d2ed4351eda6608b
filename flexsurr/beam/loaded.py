"""Models under a load: the right-hand side of any model in the beam's coordinates plus Q = Φᵀ Jᵀ F(t, q).

Where the clamp turns, F depends on the rates too: they are the model's own, η̇ of its right-hand side.

With a surrogate as the model this is the paper's augmented surrogate (its Fig. 11).
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from flexsurr.beam.chain import chain
from flexsurr.beam.clamp_rotation import TurningClamp, turning_clamp
from flexsurr.beam.clamp_sweep import clamp_work_size
from flexsurr.beam.compiled import all_joints, own, padded, rigid_elements, turned_kernel
from flexsurr.beam.described import inertial_forces, jacobians
from flexsurr.beam.kinematics import configuration, element_frames, tip_position, tip_twist, velocities
from flexsurr.beam.load_sweeps import (
    PlanarLoaded,
    SpatialLoaded,
    planar_load_work_size,
    spatial_load_work_size,
)
from flexsurr.beam.loads import Acting, Forces, Load, Part, acting, load_breakpoints, load_parts, turned
from flexsurr.beam.models import Implementation, check_implementation
from flexsurr.beam.planar import Plane, is_planar, plane
from flexsurr.beam.projection import ModalBasis, Projection, projection
from flexsurr.beam.rigid_load_sweep import RigidLoaded, rigid_load_work_size
from flexsurr.config.structure import Structure
from flexsurr.simulation.history import factor, histories_kernel
from flexsurr.simulation.rhs import Array, ByKernel, CompiledModel, Forced, Model

_STEP = 1e-30


@dataclass(frozen=True, eq=False)
class LoadedModel(Forced, ABC):
    """A model with states (η, p) of the projection, and a load; subclasses say how Q is computed."""

    projection: Projection
    load: Load

    @property
    def jumps(self) -> Iterable[float]:
        """Times [s] at which the load may jump."""
        return load_breakpoints(self.load)

    def tip(self, x: Array) -> Array:
        """(..., 3) position of the tip [m] at states x (..., 2r)."""
        return tip_position(self.projection.structure, self.projection.joints(x))

    def twist(self, x: Array) -> Array:
        """(...,) twist of the tip against the clamp [rad] at states x (..., 2r)."""
        return tip_twist(self.projection.structure, self.projection.joints(x))

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """What the load exerts, one part for each history."""
        return load_parts(self.projection.structure, self.load)

    @cached_property
    def clamp(self) -> TurningClamp | None:
        """How the clamp turns, if it does."""
        return turning_clamp(self.projection.structure, self.load.parts)

    @abstractmethod
    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at time t [s] and states x (2r,)."""


class InterpretedLoad(LoadedModel):
    """The load added in Python to what the model returns."""

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at time t [s] and states x (2r,)."""
        factors = [factor(part.history, t) for part in self.parts]
        dx = np.array(self.model.derivative(t, x))
        turning = None if self.clamp is None else self.clamp.at(t)
        if any(factors) or turning is not None:
            r = self.projection.coordinates
            now = acting(self.projection.structure.elements, self.parts, factors, turning)
            dx[r:] += self.generalised_force(x[:r], dx[:r], now)
        return dx

    @abstractmethod
    def generalised_force(self, eta: Array, rates: Array, now: Acting) -> Array:
        """Φᵀ Jᵀ F (r,) at η (r,) and η̇ (r,) of what acts now."""


class DescribedLoad(InterpretedLoad):
    """Q from the Jacobian by complex steps, joint by joint."""

    def generalised_force(self, eta: Array, rates: Array, now: Acting) -> Array:
        """Φᵀ Jᵀ F (r,) at η (r,) and η̇ (r,) of what acts now."""
        modes, structure = self.projection.modes, self.projection.structure
        q = modes @ eta
        acts = now.dead
        if any(part.any() for part in now.following):
            acts = acts.plus(turned(now.following, element_frames(structure, q)))
        jacobian = jacobians(structure, q)
        forces = jacobian.tip.T @ acts.on_tip
        for columns, force in zip(jacobian.centres, acts.on_centres, strict=True):
            forces = forces + columns.T @ force
        if acts.on_masses.any():
            for columns, force in zip(jacobian.masses, acts.on_masses, strict=True):
                forces = forces + columns.T @ force
        if acts.couples.any():
            for columns, couple in zip(_turning(structure, q), acts.couples, strict=True):
                forces = forces + columns.T @ couple
        if now.turning is not None:
            forces = forces + inertial_forces(structure, q, modes @ rates, jacobian, now.turning)
        return np.asarray(modes.T @ forces)


def _turning(structure: Structure, q: Array) -> Array:
    """(N, 3, n) angular velocity of each element for each joint rate at q (n,), by complex steps.

    With R turning at ω, Ṙ Rᵀ is the matrix of ω ×.
    """
    frames, columns = element_frames(structure, q), np.empty((structure.elements, 3, len(q)))
    for k in range(len(q)):
        step = np.zeros(len(q), dtype=complex)
        step[k] = 1j * _STEP
        spins = (element_frames(structure, q + step).imag / _STEP) @ np.swapaxes(frames, -1, -2)
        columns[:, :, k] = np.stack([spins[:, 2, 1], spins[:, 0, 2], spins[:, 1, 0]], axis=-1)
    return columns


class VectorisedLoad(InterpretedLoad):
    """Q from moments about the joints."""

    def generalised_force(self, eta: Array, rates: Array, now: Acting) -> Array:
        """Φᵀ Jᵀ F (r,) at η (r,) and η̇ (r,) of what acts now."""
        beam, modes = chain(self.projection.structure), self.projection.modes
        at, motion = configuration(beam, modes @ eta), None
        if now.turning is not None:
            motion = velocities(beam, at, (modes @ rates)[None]).combined(np.ones(1))
        return np.asarray(modes.T @ now.generalised(beam, at, motion=motion))


class VectorisedPlanarLoad(InterpretedLoad):
    """Q of a chain in a plane under dead forces and couples, by constant moment arms; the clamp at rest."""

    @cached_property
    def _frame(self) -> Plane:
        return plane(self.projection)

    def generalised_force(self, eta: Array, rates: Array, now: Acting) -> Array:
        """Φᵀ Jᵀ F (r,) at η (r,) and η̇ (r,) of what acts now."""
        arms = planar_arms(self._frame, now)
        angles = self._frame.slopes @ eta
        force: Array = (arms[1] * np.cos(angles) - arms[0] * np.sin(angles) + arms[2]) @ self._frame.slopes
        return force


def planar_arms(frame: Plane, now: Acting) -> Array:
    """(3, N) moment arms of the dead forces on a chain in a plane, and the couples about its normal [N m]."""
    forces, couples = now.dead, now.dead.couples @ np.cross(*frame.axes)
    couples = couples + now.following.couples @ frame.own_normal
    arms = frame.moment_arms(forces.on_centres, forces.on_tip)
    arms += frame.axes @ forces.on_masses.T @ frame.levers
    return np.vstack([arms, couples])


class CompiledLoad(ByKernel, LoadedModel):
    """Model and load in one kernel, the cheapest that fits the chain and the load."""

    @cached_property
    def _sweep(self) -> Literal["planar", "spatial", "rigid"]:
        structure, parts = self.projection.structure, self.parts
        if stays_planar(structure, parts):
            return "planar"
        return "spatial" if chain(structure).uniform and only_dead_forces(parts) else "rigid"

    @cached_property
    def kernel(self) -> NamedTuple:
        """The model's kernel within the load's."""
        space = self.projection
        model: NamedTuple = self.model.kernel
        if self.clamp is not None:
            model = turned_kernel(model, space, self.clamp)
        if not self.parts:
            return model
        histories = histories_kernel([part.history for part in self.parts])
        beam = chain(space.structure)
        if self._sweep == "planar":
            frame = plane(space)
            arms = [planar_arms(frame, acting(beam.elements, [part], [1.0])) for part in self.parts]
            return PlanarLoaded(model, padded(frame.slopes.T), padded(np.array(arms)), histories)
        modes = all_joints(space)
        forces = Forces(
            *(own(np.array(each)) for each in zip(*(part.forces for part in self.parts), strict=True))
        )
        if self._sweep == "spatial":
            return SpatialLoaded(
                model, modes, own(beam.clamp), beam.element_length, np.zeros(3),
                forces.on_centres, forces.on_tip, histories,
            )  # fmt: skip
        follows = np.array([part.follows for part in self.parts])
        return RigidLoaded(model, modes, rigid_elements(beam), *forces, follows, histories)

    @property
    def work_size(self) -> int:
        """Model and load use the same scratch, one after the other."""
        sizes = {
            "planar": planar_load_work_size,
            "spatial": spatial_load_work_size,
            "rigid": rigid_load_work_size,
        }
        elements = self.projection.structure.elements
        turned = 0 if self.clamp is None else clamp_work_size(elements)
        return int(max(self.model.work_size, turned, sizes[self._sweep](elements)))


def loaded(
    model: Model, system: Structure | ModalBasis, load: Load, implementation: Implementation
) -> LoadedModel:
    """`model` under `load`; its states must be those of `system`: (q, p), or (η, p) of a basis.

    `model` may be a full-order or reduced-order model or a surrogate. Its `energy` is kept if it has one.
    ValueError where the number of states differs, and for a clamp that cannot turn so; TypeError for a
    compiled load on a model without a kernel.
    """
    check_implementation(implementation)
    space = projection(system)
    if len(model.state_names) != 2 * space.coordinates:
        raise ValueError(
            f"the model has {len(model.state_names)} states, the structure's coordinates make "
            f"{2 * space.coordinates}"
        )
    if implementation == "described":
        return DescribedLoad(model, space, load)
    if implementation == "compiled":
        if not isinstance(model, CompiledModel):
            raise TypeError(f"a compiled load needs a compiled model; {type(model).__name__} has no kernel")
        return CompiledLoad(model, space, load)
    planar = turning_clamp(space.structure, load.parts) is None and stays_planar(
        space.structure, load_parts(space.structure, load)
    )
    return VectorisedPlanarLoad(model, space, load) if planar else VectorisedLoad(model, space, load)


def only_dead_forces(parts: Sequence[Part]) -> bool:
    """Whether nothing but dead forces on the elastic axis acts."""
    return not any(part.follows or part.forces.on_masses.any() or part.forces.couples.any() for part in parts)


def stays_planar(structure: Structure, parts: Sequence[Part]) -> bool:
    """Whether the chain stays in a plane, and constant moment arms tell what the load exerts."""
    return is_planar(structure) and all(not part.follows or part.forces.only_couples for part in parts)
