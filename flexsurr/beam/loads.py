"""What the loads of flexsurr.config.load exert on the chain, and the generalised forces of it all."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from flexsurr.beam.chain import Chain, chain
from flexsurr.beam.clamp_rotation import Turning, turning_clamp
from flexsurr.beam.kinematics import Configuration, Velocities, generalised_forces
from flexsurr.beam.planar import is_planar
from flexsurr.config.history import Constant
from flexsurr.config.load import (
    ClampAcceleration,
    ClampRotation,
    DistributedForce,
    DistributedMoment,
    Pushing,
    SeveralLoads,
    Shape,
    Single,
    TipForce,
    TipMoment,
    Vector,
    loaded_span,
)
from flexsurr.config.structure import Structure
from flexsurr.simulation.history import History, breakpoints, end_s, factor
from flexsurr.simulation.rhs import Array

Load = Single | SeveralLoads


class Forces(NamedTuple):
    """What acts on the chain: of a dead load in the clamp's frame before it is turned.

    Of one that follows, each element's in its own axes, and the tip's in those of the last element.
    """

    on_centres: Array  # (..., N, 3) on the elements' centres, on the elastic axis [N]
    on_tip: Array  # (..., 3) [N]
    on_masses: Array  # (..., N, 3) on the lumped masses, off the axis [N]
    couples: Array  # (..., N, 3) moments on the elements [N m]

    @classmethod
    def none(cls, elements: int) -> "Forces":
        """Nothing at all."""
        return cls(np.zeros((elements, 3)), np.zeros(3), np.zeros((elements, 3)), np.zeros((elements, 3)))

    def times(self, number: float) -> "Forces":
        """All of it times a number."""
        return Forces(*(number * part for part in self))

    def plus(self, other: "Forces") -> "Forces":
        """Both together."""
        return Forces(*(a + b for a, b in zip(self, other, strict=True)))

    @property
    def only_couples(self) -> bool:
        """Whether no force acts."""
        return not (self.on_centres.any() or self.on_tip.any() or self.on_masses.any())


class Part(NamedTuple):
    """A load of one history: what it exerts at a factor of 1, and whether it turns with the elements."""

    forces: Forces
    follows: bool
    history: History


class Acting(NamedTuple):
    """What acts at one instant."""

    dead: Forces
    following: Forces
    turning: Turning | None = None  # of the clamp

    def generalised(
        self,
        beam: Chain,
        at: Configuration,
        on_masses: Array | None = None,
        motion: Velocities | None = None,
    ) -> Array:
        """(..., n) Q at a configuration; `on_masses` (N, 3) [N] acts besides.

        `motion` is what a turning clamp asks for; without it the chain is at rest against the clamp.
        A joint feels the moment about it of all forces from its element outwards (see `generalised_forces`),
        and all couples from its element outwards.
        """
        forces = self.dead
        if any(part.any() for part in self.following):
            forces = forces.plus(turned(self.following, at.frames))
        weights, couples = forces.on_masses, forces.couples
        if on_masses is not None:
            weights = weights + on_masses
        if self.turning is not None:
            pushes, moments = self.turning.exerted(beam, at, motion)
            weights, couples = weights + pushes, couples + moments
        # the tip's force beside the elements', whatever the leading axes
        on_tip = forces.on_tip[..., None, :]
        generalised = generalised_forces(beam, at, weights, forces.on_centres, on_tip)
        if not couples.any():
            return generalised
        return np.asarray(generalised + of_couples(beam, at, couples))


# ∫ of each shape from the clamp to ξ = x/L.
_INTEGRALS: dict[Shape, Callable[[Array], Array]] = {
    "uniform": lambda xi: xi,
    "linear": lambda xi: 0.5 * xi**2,
    "elliptic": lambda xi: 0.5 * (xi * np.sqrt(1.0 - xi**2) + np.arcsin(xi)),
    "one_minus_elliptic": lambda xi: xi - _INTEGRALS["elliptic"](xi),
}


def load_parts(structure: Structure, load: Load) -> tuple[Part, ...]:
    """What `load` exerts whatever the velocities, part by part: all of it but a turning clamp.

    ValueError for a load outside the span.
    """
    return tuple(
        Part(load_forces(structure, part), getattr(part, "follows", False), part.history)
        for part in load.parts
        if not isinstance(part, ClampRotation)
    )


def load_forces(structure: Structure, load: Pushing) -> Forces:
    """The forces of `load` at a factor of 1; distributed ones by eqs. 13 and 14.

    ValueError for a load outside the span.
    """
    forces = Forces.none(structure.elements)
    match load:
        case TipForce():
            forces.on_tip[:] = load.force_N * _unit(load.direction)
        case TipMoment():
            forces.couples[-1] = load.moment_N_m * _unit(load.direction)
        case ClampAcceleration():
            beam = chain(structure)
            forces.on_masses[:] = -beam.masses[:, None] * load.acceleration_m_s2 * _unit(load.direction)
        case DistributedMoment():
            forces.couples[:] = _on_elements(structure, load)
        case DistributedForce(acts_on="span"):
            forces.on_centres[:] = _on_elements(structure, load)
        case DistributedForce():
            forces.on_tip[:] = _on_elements(structure, load).sum(axis=0)
    return forces


def _unit(direction: Vector) -> Array:
    return np.asarray(np.array(direction) / math.hypot(*direction))  # however small


def _on_elements(structure: Structure, load: DistributedForce | DistributedMoment) -> Array:
    """(N, 3) what each element receives: the integral over its own span."""
    span = structure.length_m
    ends = np.clip(np.linspace(0.0, span, structure.elements + 1), *loaded_span(load, span)) / span
    received = np.zeros((structure.elements, 3))
    for axis, spread in enumerate(load.spreads):
        if spread is not None:
            received[:, axis] = spread.size * span * np.diff(_INTEGRALS[spread.shape](ends))
    return received


def acting(
    elements: int, parts: Sequence[Part], factors: Sequence[float], turning: Turning | None = None
) -> Acting:
    """All parts together, each times its factor, and a clamp that turns."""
    sums = {follows: Forces.none(elements) for follows in (False, True)}
    for part, number in zip(parts, factors, strict=True):
        sums[part.follows] = sums[part.follows].plus(part.forces.times(number))
    return Acting(sums[False], sums[True], turning)


def turned(forces: Forces, frames: Array) -> Forces:
    """Forces in the elements' own axes as dead ones, for elements turned as `frames` (..., N, 3, 3)."""
    on_centres, on_masses, couples = (
        np.einsum("...nij,...nj->...ni", frames, part)
        for part in (forces.on_centres, forces.on_masses, forces.couples)
    )
    return Forces(on_centres, frames[..., -1, :, :] @ forces.on_tip, on_masses, couples)


def of_couples(beam: Chain, at: Configuration, couples: Array) -> Array:
    """(..., n) generalised forces of moments on the elements (..., N, 3) [N m]."""
    outboard = np.cumsum(couples[..., ::-1, :], axis=-2)[..., ::-1, :]
    rotations = np.sum(at.axes[..., :3, :, :] * outboard[..., None, :, :], axis=-1)
    joints = np.concatenate([rotations, np.zeros_like(rotations[..., :1, :])], axis=-2)
    return joints.reshape(*joints.shape[:-2], 4 * beam.elements)[..., beam.rows]


def static_load(structure: Structure, load: Load | None, at_s: float | None = None) -> Acting:
    """What a constant load exerts, or any load held as it is at `at_s` [s]: of a turning clamp, its rate.

    ValueError for a load that changes with time where no instant is given.
    """
    if load is None:
        return acting(structure.elements, (), ())
    parts, clamp = load_parts(structure, load), turning_clamp(structure, load.parts)
    turning = None if clamp is None else clamp.held(at_s)
    if at_s is not None:
        return acting(structure.elements, parts, [factor(part.history, at_s) for part in parts], turning)
    if not all(isinstance(part.history, Constant) for part in parts):
        raise ValueError(f"{load} changes with time: it has no static equilibrium")
    return acting(structure.elements, parts, [1.0] * len(parts), turning)


def has_potential(structure: Structure, at_rest: Acting) -> bool:
    """Whether the load's work depends on the shape alone, so that its tangent stiffness is symmetric.

    Dead forces have a potential, as have centrifugal ones, and moments in the plane of a chain that stays in
    one. What follows has none, nor has a moment about an axis fixed in space.
    """
    if not at_rest.following.only_couples:
        return False
    couples = at_rest.dead.couples.any() or at_rest.following.couples.any()
    return not couples or is_planar(structure)


def load_ends_s(load: Load) -> float:
    """When the last part of it ends [s]; infinite where one does not, and where a clamp has turned."""
    return max(math.inf if isinstance(part, ClampRotation) else end_s(part.history) for part in load.parts)


def load_breakpoints(load: Load) -> set[float]:
    """Times [s] at which the load, or its rate, may jump."""
    return {time for part in load.parts for time in breakpoints(part.history)}
