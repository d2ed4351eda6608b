"""What the models of the beam have in common, whatever computes their right-hand side.

States are (η, p) with q = Φ η and p = M(η) η̇, and (eqs. 6, 7, 10)

    η̇ = M⁻¹ p
    ṗ = −K η − C η̇ + ½ ∂/∂η (η̇ᵀ M η̇) + Q

The term with ½ is the gyroscopic one: the variant `hamiltonian` keeps it, `as_printed` drops it.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexsurr.beam.chain import chain, rotary_inertia
from flexsurr.beam.kinematics import Configuration, configuration, projected_mass, tip_position, tip_twist
from flexsurr.beam.projection import Projection
from flexsurr.config.study import Variant
from flexsurr.simulation.rhs import Array


@dataclass(frozen=True, eq=False)
class BeamModel(ABC):
    """States, energy and tip of a full-order or reduced-order model; subclasses add `derivative`."""

    projection: Projection
    variant: Variant

    @property
    def state_names(self) -> tuple[str, ...]:
        """η or q first, then their momenta."""
        return self.projection.state_names

    @property
    def state_units(self) -> tuple[str, ...]:
        """Units of the states, in their order."""
        return self.projection.state_units

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """None: without a load the right-hand side does not depend on time."""
        return ()

    @cached_property
    def joint_inertia(self) -> Array:
        """I (n, n) [kg m²], constant."""
        return rotary_inertia(self.projection.structure)

    @cached_property
    def rotary_inertia(self) -> Array:
        """Φᵀ I Φ (r, r)."""
        return self.projection.modes.T @ self.joint_inertia @ self.projection.modes

    @abstractmethod
    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at states x (2r,); the time t [s] has no effect."""

    def energy(self, x: Array) -> Array:
        """H = ½ pᵀ M⁻¹ p + ½ ηᵀ K η − Σ m g·(r − r(0)) (...,) [J] of states x (..., 2r).

        Eqs. 3 and 4, and gravity. Constant along undamped, unloaded motion of the hamiltonian variant.
        Complex states are taken too, for derivatives by complex steps.
        """
        modes, r = self.projection.modes, self.projection.coordinates
        x = np.asarray(x)
        eta, momenta = x[..., :r], x[..., r:]
        beam = chain(self.projection.structure)
        at = configuration(beam, eta @ modes.T)
        mass = self._mass(at)
        kinetic = 0.5 * np.sum(momenta * np.linalg.solve(mass, momenta[..., None])[..., 0], axis=-1)
        elastic = 0.5 * np.sum(eta * (eta @ self.projection.stiffness.T), axis=-1)
        undeformed = configuration(beam, np.zeros(beam.coordinates)).masses
        fall = (beam.masses @ (at.masses - undeformed)) @ beam.gravity
        energy: Array = kinetic + elastic - fall
        return energy

    def mass_matrix(self, eta: Array) -> Array:
        """M (..., r, r) at η (..., r), with p = M η̇."""
        beam = chain(self.projection.structure)
        return self._mass(configuration(beam, np.asarray(eta) @ self.projection.modes.T))

    def _mass(self, at: Configuration) -> Array:
        beam = chain(self.projection.structure)
        return projected_mass(beam, at, self.projection.modes) + self.rotary_inertia

    def tip(self, x: Array) -> Array:
        """(..., 3) position of the tip [m] at states x (..., 2r)."""
        return tip_position(self.projection.structure, self.projection.joints(x))

    def twist(self, x: Array) -> Array:
        """(...,) twist of the tip against the clamp [rad] at states x (..., 2r)."""
        return tip_twist(self.projection.structure, self.projection.joints(x))
