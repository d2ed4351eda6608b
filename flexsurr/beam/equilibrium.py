"""Static equilibria under gravity and constant loads (eq. 8), followed from the undeformed shape.

Gravity and load grow together by a factor λ from 0 to 1. As long as the tangent stiffness Φᵀ (K − λ ∂Q/∂q) Φ
is positive definite, the equilibrium is stable and η moves on with λ at the rate that solves
(tangent) dη/dλ = Φᵀ Q. Where it is not, the structure buckles. Full order is the case Φ = 1.

A load without a potential has a tangent that is not symmetric. Its path is followed as long as the tangent's
determinant stays positive; that the equilibrium is stable is not shown.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from flexsurr.beam.chain import chain, check_coordinates
from flexsurr.beam.kinematics import configuration
from flexsurr.beam.loads import Acting, Load, has_potential, static_load
from flexsurr.beam.projection import ModalBasis, Projection, projection
from flexsurr.config.structure import JOINTS, Structure
from flexsurr.simulation.rhs import Array

_COMPLEX_STEP = 1e-30  # no cancellation, so as small as one likes
_ITERATIONS = 12
_TOLERANCE = 1e-12  # residual over the size of springs' and loads' moments
# A step that turns the chain further, or whose corrections are larger than this part of what came before
# them, may come round to another equilibrium.
_LARGEST_TURN_RAD = 1.0
_CONTRACTION = 0.5
_SMALLEST_STEP = 2.0**-30


class EquilibriumNotFound(ArithmeticError):
    """The structure buckles before the whole load acts, or has; the message is one line and says where."""


def find_equilibrium(
    system: Structure | ModalBasis, load: Load | None = None, at_s: float | None = None
) -> Array:
    """The η (r,) with Φᵀ (K q − Q(q)) = 0 under gravity and `load`, eq. 8; q for a structure.

    Of all equilibria it is the one to which the undeformed shape leads as gravity and load grow together.
    Under a load without a potential, such as one that follows, it need not be stable. Where the clamp turns
    it is at rest against the clamp, and its stability is that without Coriolis forces.
    A load that changes with time is held as it is at `at_s` [s], a clamp at its rate. Raises
    EquilibriumNotFound where the path becomes unstable, and ValueError for a load that changes with time
    where no instant is given.
    """
    balance = _Balance(projection(system), static_load(_structure(system), load, at_s))
    eta, reached, step = np.zeros(balance.space.coordinates), 0.0, 1.0
    while reached < 1.0:
        forces, gradient = balance.forces(eta)
        rate = np.asarray(np.linalg.solve(balance.space.stiffness - reached * gradient, forces), dtype=float)
        step = min(step, 1.0 - reached, _LARGEST_TURN_RAD / max(balance.turn(rate), 1e-300))
        while (found := balance.corrected(eta, step * rate, reached + step)) is None:
            step *= 0.5
            if step < _SMALLEST_STEP:
                raise EquilibriumNotFound(_buckling(system, load, balance.load, reached))
        eta, reached, step = found, reached + step, 2.0 * step
    return eta


def static_residual(structure: Structure, q: Array, load: Load | None = None) -> Array:
    """K q − Q(q) (..., n) at q (..., n), with gravity and `load`."""
    balance = _Balance(projection(structure), static_load(structure, load))
    return q @ balance.space.stiffness - balance.generalised(q)


def tangent_stiffness(structure: Structure, q: Array, load: Load | None = None) -> Array:
    """(n, n) K − ∂Q/∂q at q (n,): springs and geometric stiffness; symmetric if the load has a potential."""
    check_coordinates(structure, q)
    balance = _Balance(projection(structure), static_load(structure, load))
    return balance.space.stiffness - balance.forces(q)[1]


@dataclass(frozen=True, eq=False)
class _Balance:
    """Springs against gravity and a constant load."""

    space: Projection
    load: Acting

    @cached_property
    def conservative(self) -> bool:
        """Whether the load has a potential, as gravity has."""
        return has_potential(self.space.structure, self.load)

    def generalised(self, eta: Array) -> Array:
        """Φᵀ Q (..., r) at η (..., r)."""
        beam = chain(self.space.structure)
        weights = beam.masses[:, None] * beam.gravity
        at = configuration(beam, eta @ self.space.modes.T)
        return self.load.generalised(beam, at, weights) @ self.space.modes

    def forces(self, eta: Array) -> tuple[Array, Array]:
        """Φᵀ Q (r,) and Φᵀ ∂Q/∂q Φ (r, r) at η (r,): all columns by complex steps at once."""
        found = self.generalised(eta + 1j * _COMPLEX_STEP * np.eye(len(eta)))
        gradient = found.imag / _COMPLEX_STEP
        if not self.conservative:
            return found[0].real, gradient.T
        # Forces that have a potential give a symmetric tangent; averaging removes the rounding.
        return found[0].real, 0.5 * (gradient + gradient.T)

    def solved(self, tangent: Array, residual: Array) -> Array:
        """(r,) what the tangent (r, r) takes to the residual (r,); LinAlgError past a point of no return."""
        if self.conservative:
            return np.asarray(cho_solve(cho_factor(tangent), residual))
        if np.linalg.slogdet(tangent)[0] <= 0.0:
            raise LinAlgError
        return np.asarray(np.linalg.solve(tangent, residual))

    def turn(self, change: Array) -> float:
        """By how much a change of η (r,) turns the joints, all together [rad]."""
        rotations = chain(self.space.structure).rows < JOINTS.index("axial") * self.space.structure.elements
        return float(np.abs(self.space.modes @ change)[rotations].sum())

    def corrected(self, eta: Array, change: Array, factor: float) -> Array | None:
        """The stable equilibrium (r,) at `factor` by Newton's method from η + change.

        None where an iterate is unstable, the corrections do not shrink or the residual stays.
        """
        springs = self.space.stiffness
        applied = factor * self._size()
        found, size = eta + change, _energy(springs, change)
        for _ in range(_ITERATIONS):
            forces, gradient = self.forces(found)
            residual = springs @ found - factor * forces
            try:
                correction = self.solved(springs - factor * gradient, residual)
            except LinAlgError:
                return None
            scale = float(np.linalg.norm(springs @ found)) + applied
            if float(np.linalg.norm(residual)) <= _TOLERANCE * scale:
                return np.asarray(found - correction)
            previous, size = size, _energy(springs, correction)
            if not size <= _CONTRACTION * previous:
                return None
            found = found - correction
        return None

    def _size(self) -> float:
        """A bound of Φᵀ Q: gravity and load as a moment over the length [N m], through the modes."""
        beam = chain(self.space.structure)
        forces = float(beam.masses.sum() * np.linalg.norm(beam.gravity))
        couples = 0.0
        if (turning := self.load.turning) is not None:
            reach = self.space.structure.length_m + float(np.linalg.norm(turning.arm))
            centrifugal = reach * float(turning.velocity @ turning.velocity)
            forces += float(beam.masses.sum()) * (centrifugal + float(np.linalg.norm(turning.tilt)))
        for load in (self.load.dead, self.load.following):
            pushes = (*load.on_centres, load.on_tip, *load.on_masses)
            forces += float(sum(np.linalg.norm(push) for push in pushes))
            couples += float(sum(np.linalg.norm(couple) for couple in load.couples))
        moments = forces * self.space.structure.length_m + couples
        return float(moments * np.linalg.norm(self.space.modes, 2))


def _energy(springs: Array, change: Array) -> float:
    """The square root of the springs' work over a change of η: a norm whatever the units of η."""
    return float(np.sqrt(change @ springs @ change))


def _structure(system: Structure | ModalBasis) -> Structure:
    return system.structure if isinstance(system, ModalBasis) else system


def _buckling(system: Structure | ModalBasis, load: Load | None, acts: Acting, factor: float) -> str:
    structure = _structure(system)
    name = structure.name
    if isinstance(system, ModalBasis):
        name += f" in {system.modes.shape[1]} mode(s)"
    causes = []
    if acts.turning is not None:
        causes.append(f"at {np.sqrt(factor) * np.linalg.norm(acts.turning.velocity):.4g} rad/s")
    if load is not None and any(part.any() for forces in (acts.dead, acts.following) for part in forces):
        forces = acts.dead.plus(acts.following)
        total = np.linalg.norm((forces.on_centres + forces.on_masses).sum(axis=0) + forces.on_tip)
        couple = np.linalg.norm(forces.couples.sum(axis=0))
        size = f"{factor * total:.4g} N" if total > 0.0 else f"{factor * couple:.4g} N m"
        causes.append(f"at {size} ({load.kind.replace('_', ' ')})")
    if structure.gravity_m_s2 > 0.0:
        causes.append(f"under {100.0 * factor:.3g} % of its own weight")
    return f"{name}: buckles {' '.join(causes)}"
