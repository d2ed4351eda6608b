"""Models under a load: the right-hand side of any model in the beam's coordinates plus Q = Φᵀ Jᵀ F(t).

With a surrogate as the model this is the paper's augmented surrogate (its Fig. 11).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from flexsurr.beam.chain import chain
from flexsurr.beam.compiled import all_joints, own, padded, rigid_elements
from flexsurr.beam.described import jacobians
from flexsurr.beam.kinematics import configuration, generalised_forces, tip_position, tip_twist
from flexsurr.beam.load_sweeps import (
    PlanarLoaded,
    SpatialLoaded,
    planar_load_work_size,
    spatial_load_work_size,
)
from flexsurr.beam.loads import Forces, Load, load_forces
from flexsurr.beam.models import Implementation, check_implementation
from flexsurr.beam.planar import is_planar, plane
from flexsurr.beam.projection import ModalBasis, Projection, projection
from flexsurr.beam.rigid_load_sweep import RigidLoaded, rigid_load_work_size
from flexsurr.config.structure import Structure
from flexsurr.simulation.history import breakpoints, factor, history_kernel
from flexsurr.simulation.rhs import Array, CompiledModel, Model, evaluate


@dataclass(frozen=True, eq=False)
class LoadedModel(ABC):
    """A model and a load; subclasses say how Q is computed."""

    model: Any  # a Model with states (η, p) of the projection
    projection: Projection
    load: Load

    @property
    def state_names(self) -> tuple[str, ...]:
        """Those of the model."""
        names: tuple[str, ...] = self.model.state_names
        return names

    @property
    def state_units(self) -> tuple[str, ...]:
        """Those of the model."""
        units: tuple[str, ...] = self.model.state_units
        return units

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Times [s] at which the load, or the model itself, may jump."""
        return tuple(sorted({*self.model.breakpoints, *breakpoints(self.load.history)}))

    @property
    def energy(self) -> Any:
        """The model's own energy, without the work of the load; AttributeError where it has none."""
        return self.model.energy

    def tip(self, x: Array) -> Array:
        """(..., 3) position of the tip [m] at states x (..., 2r)."""
        return tip_position(self.projection.structure, self.projection.joints(x))

    def twist(self, x: Array) -> Array:
        """(...,) twist of the tip against the clamp [rad] at states x (..., 2r)."""
        return tip_twist(self.projection.structure, self.projection.joints(x))

    @cached_property
    def forces(self) -> Forces:
        """What the load exerts at a factor of 1."""
        return load_forces(self.projection.structure, self.load)

    @abstractmethod
    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at time t [s] and states x (2r,)."""


class InterpretedLoad(LoadedModel):
    """The load added in Python to what the model returns."""

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at time t [s] and states x (2r,)."""
        now = factor(self.load.history, t)
        dx = np.array(self.model.derivative(t, x))
        if now != 0.0:
            r = self.projection.coordinates
            dx[r:] += now * self.generalised_force(x[:r])
        return dx

    @abstractmethod
    def generalised_force(self, eta: Array) -> Array:
        """Φᵀ Jᵀ F (r,) at η (r,), at a factor of 1."""


class DescribedLoad(InterpretedLoad):
    """Q from the Jacobian by complex steps, joint by joint."""

    def generalised_force(self, eta: Array) -> Array:
        """Φᵀ Jᵀ F (r,) at η (r,)."""
        on_centres, on_tip = self.forces
        modes, structure = self.projection.modes, self.projection.structure
        jacobian = jacobians(structure, modes @ eta)
        forces = jacobian.tip.T @ on_tip
        for columns, force in zip(jacobian.centres, on_centres, strict=True):
            forces = forces + columns.T @ force
        return modes.T @ forces


class VectorisedLoad(InterpretedLoad):
    """Q from moments about the joints."""

    @cached_property
    def _nothing(self) -> Array:
        return np.zeros((self.projection.structure.elements, 3))

    def generalised_force(self, eta: Array) -> Array:
        """Φᵀ Jᵀ F (r,) at η (r,)."""
        beam, modes = chain(self.projection.structure), self.projection.modes
        at = configuration(beam, modes @ eta)
        return modes.T @ generalised_forces(beam, at, self._nothing, *self.forces)


class VectorisedPlanarLoad(InterpretedLoad):
    """Q of a chain in a plane, from constant moment arms."""

    @cached_property
    def _arms(self) -> tuple[Array, Array]:
        frame = plane(self.projection)
        return frame.slopes, frame.moment_arms(self.forces.on_centres, self.forces.on_tip)

    def generalised_force(self, eta: Array) -> Array:
        """Φᵀ Jᵀ F (r,) at η (r,)."""
        slopes, arms = self._arms
        angles = slopes @ eta
        force: Array = (arms[1] * np.cos(angles) - arms[0] * np.sin(angles)) @ slopes
        return force


class CompiledLoad(LoadedModel):
    """Model and load in one kernel."""

    @cached_property
    def kernel(self) -> NamedTuple:
        """The model's kernel within the load's."""
        history = history_kernel(self.load.history)
        if is_planar(self.projection.structure):
            frame = plane(self.projection)
            arms = frame.moment_arms(self.forces.on_centres, self.forces.on_tip)
            return PlanarLoaded(self.model.kernel, padded(frame.slopes.T), padded(arms), history)
        beam = chain(self.projection.structure)
        modes, load = all_joints(self.projection), self.forces
        if not beam.uniform:
            return RigidLoaded(
                self.model.kernel, modes, rigid_elements(beam), np.zeros((beam.elements, 3)),
                own(load.on_centres), own(load.on_tip), history,
            )  # fmt: skip
        return SpatialLoaded(
            self.model.kernel, modes, own(beam.clamp), beam.element_length, np.zeros(3),
            own(load.on_centres), own(load.on_tip), history,
        )  # fmt: skip

    @property
    def work_size(self) -> int:
        """Model and load use the same scratch, one after the other."""
        structure = self.projection.structure
        if is_planar(structure):
            load = planar_load_work_size
        else:
            load = spatial_load_work_size if chain(structure).uniform else rigid_load_work_size
        return int(max(self.model.work_size, load(structure.elements)))

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at time t [s] and states x (2r,)."""
        x = np.ascontiguousarray(x, dtype=np.float64)
        dx = np.empty_like(x)
        evaluate(self.kernel, float(t), x, dx, np.empty(self.work_size))
        return dx


def loaded(
    model: Model, system: Structure | ModalBasis, load: Load, implementation: Implementation
) -> LoadedModel:
    """`model` under `load`; its states must be those of `system`: (q, p), or (η, p) of a basis.

    `model` may be a full-order or reduced-order model or a surrogate. Its `energy` is kept if it has one.
    ValueError where the number of states differs; TypeError for a compiled load on a model without a kernel.
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
    planar = is_planar(space.structure)
    return VectorisedPlanarLoad(model, space, load) if planar else VectorisedLoad(model, space, load)
