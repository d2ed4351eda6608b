"""The chain in intrinsic variables: velocities and strains as states, whose equations are exactly quadratic.

Element i has the velocity v = (V, Ω) of its centre of gravity, along its own axes; a joint the strain
ε = (γ, θ) by which what it joins is apart and turned. With + after the joint, − before it, both at the joint,
and a bar for their mean

    γ̇ = V⁺ − V⁻ + θ × V̄ + γ × Ω̄,     θ̇ = Ω⁺ − Ω⁻ + θ × Ω̄,     M v̇ = −Ω × M v − B(ε)ᵀ σ

where B(ε) v are the rates of strain and σ the forces and moments in the joints. That is, joint by joint, what
D. H. Hodges has of a continuous beam ("Geometrically-exact, intrinsic theory for dynamics of curved and
twisted, anisotropic beams"); products of two strains of one joint are left out, of which a finer chain has
less. With v = Σ φ q, ε = Σ ψ s and σ = Σ τ s of linear modes, ψ = B(0) φ / ω, B(0)ᵀ τ = ω M φ, it is

    q̇ = −ω s − Γ₁ q q − Γ₂ s s,     ṡ = ω q + Γ₂ᵀ q s

(A. Cea and R. Palacios, "A nearly-real time nonlinear aeroelastic simulation architecture based on JAX"). All
of it turns x = (q, s) without making it longer: ẋ = S(x) x with S skew. So ½ |x|², the energy, stays.

An axis that does not shear has no modes of shear, so their velocities and forces, of second order in a bent
axis that twists, are left out whatever the number of modes; in a plane they do no work.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexsurr.beam.chain import Chain, chain
from flexsurr.beam.kinematics import tip_position, tip_twist
from flexsurr.beam.modes import natural_modes
from flexsurr.beam.rotation_vector import crosses
from flexsurr.config.structure import Joint, Structure
from flexsurr.simulation.rhs import Array, ByKernel, implements_rhs

ROUNDING = 1e-10
"""Coefficients of less, beside the largest, are zero by symmetry."""

AXES: dict[Joint, tuple[int, float]] = {
    "axial": (0, 1.0),
    "torsion": (3, 1.0),
    "out_of_plane": (4, -1.0),
    "in_plane": (5, 1.0),
}
"""Which component of a joint's strain each coordinate is, and its sense."""


class Turns(NamedTuple):
    """ẋ = S(x) x: ω couples q_k and s_k; each further turn of two states goes with a third."""

    omega: Array  # (k,) [rad/s]
    pairs: NDArray[np.int64]  # (m, 3) places of the two states that turn, and of the one with which they do
    weights: Array  # (m,)


@implements_rhs(Turns, inline=False)
def turns_rhs(kernel, t, x, dx, work):
    """Each turn takes from one state's square what it gives to the other's."""
    modes = kernel.omega.shape[0]
    for k in range(modes):
        dx[k] = -kernel.omega[k] * x[modes + k]
        dx[modes + k] = kernel.omega[k] * x[k]
    for m in range(kernel.weights.shape[0]):
        to, by = kernel.pairs[m, 0], kernel.pairs[m, 1]
        rate = kernel.weights[m] * x[kernel.pairs[m, 2]]
        dx[to] += rate * x[by]
        dx[by] -= rate * x[to]


@dataclass(frozen=True, eq=False)
class IntrinsicModel(ByKernel):
    """Some modes of a straight, undamped, weightless chain: states (q, s) [J½], a pair for each mode.

    `kept` (k,) says which of the structure's `natural_modes`. A chain that hardly stretches needs some of
    those in which it does (the joint `axial`): as it bends, its tip comes in. ValueError for a chain of any
    other kind.
    """

    structure: Structure
    kept: Sequence[int]

    def __post_init__(self) -> None:
        beam = chain(self.structure)
        reasons = {
            "is bent or twisted": beam.turns is not None,
            "is heavy": bool(np.any(beam.gravity)),
            "is damped": bool(np.any(beam.damping)),
            "turns joint by joint": not beam.by_vector and len(set(self.structure.joints) - {"axial"}) > 1,
            "has a constant rotary inertia": bool(np.any(beam.torsion_inertia)),
        }
        for reason, holds in reasons.items():
            if holds:
                raise ValueError(f"{self.structure.name} {reason}: it has no intrinsic form here")

    @cached_property
    def _modes(self) -> tuple[Array, Array]:
        """Frequencies (k,) and modes (n, k) of those kept."""
        omega, modes = natural_modes(self.structure, np.zeros(self.structure.coordinates))
        kept = list(self.kept)
        return omega[kept], modes[:, kept]

    @property
    def state_names(self) -> tuple[str, ...]:
        """Velocities, then strains, of each mode."""
        return tuple(f"{kind}_{k + 1}" for kind in ("velocity", "strain") for k in self.kept)

    @property
    def state_units(self) -> tuple[str, ...]:
        """Roots of energies, all of them."""
        return ("J^½",) * (2 * len(self.kept))

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """None."""
        return ()

    @property
    def work_size(self) -> int:
        """None is needed."""
        return 0

    @cached_property
    def kernel(self) -> Turns:
        """The coefficients of the equations, those that are zero left out."""
        return turns(self.structure, *self._modes)

    def at_rest(self, q: Array) -> Array:
        """States (2k,) of the chain held at the coordinates q (n,), as far as the kept modes show them."""
        omega, modes = self._modes
        strains = (modes.T * chain(self.structure).stiffness) @ q / omega
        return np.concatenate([np.zeros_like(omega), strains])

    def joints(self, x: Array) -> Array:
        """Joint coordinates q (..., n) of the states x (..., 2k), from their strains."""
        omega, modes = self._modes
        return np.asarray(x[..., len(omega) :] / omega @ modes.T)

    def tip(self, x: Array) -> Array:
        """(..., 3) position of the tip [m] at states x (..., 2k): the strains, summed along the span."""
        return tip_position(self.structure, self.joints(x))

    def twist(self, x: Array) -> Array:
        """(...,) twist of the tip against the clamp [rad] at states x (..., 2k)."""
        return tip_twist(self.structure, self.joints(x))

    def energy(self, x: Array) -> Array:
        """½ |x|² (...,) [J] of states x (..., 2k)."""
        return np.asarray(0.5 * np.sum(x * x, axis=-1))


def stretching_modes(structure: Structure) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The places among `natural_modes` of those that bend and twist, and of those that stretch the axis."""
    omega, modes = natural_modes(structure, np.zeros(structure.coordinates))
    beam = chain(structure)
    axial = np.repeat([joint == "axial" for joint in structure.ordered_joints], beam.elements)
    stretched = (beam.stiffness * axial) @ modes**2 > 0.5 * omega**2
    return np.flatnonzero(~stretched), np.flatnonzero(stretched)


def joint_velocities(beam: Chain) -> tuple[Array, Array]:
    """(N, 6, 6 N) each: velocities (V, Ω) after and before each joint, at the joint, of the elements'.

    Ω × r is that of an element's point at r from its centre of gravity.
    """
    n = beam.elements
    after, before = np.zeros((2, n, 6, n, 6))
    at = np.arange(n)
    # what two arrays of places pick out comes first, the slices between them last
    after[at, :, at] = _rigid(-beam.arms)
    before[at[1:], :, at[:-1]] = _rigid(beam.spans - beam.arms)[:-1]
    return after.reshape(n, 6, 6 * n), before.reshape(n, 6, 6 * n)


def strain_products(mean: Array, strains: Array, velocities: Array) -> Array:
    """(N, 6, l, k) what l `strains` (N, 6, l) add to the rates of strain of k `velocities` (6 N, k).

    θ × V̄ + γ × Ω̄ and θ × Ω̄; `mean` (N, 6, 6 N) is of the velocities after and before each joint.
    """
    moved = mean @ velocities
    linear, angular = moved[:, :3, None], moved[:, 3:, None]
    apart, turned = strains[:, :3, :, None], strains[:, 3:, :, None]
    of_apart = np.cross(turned, linear, axis=1) + np.cross(apart, angular, axis=1)
    return np.concatenate([of_apart, np.cross(turned, angular, axis=1)], axis=1)


def strains_of(structure: Structure, q: Array) -> Array:
    """(N, 6, k) strains (γ, θ) of the joints at the coordinates q (n, k)."""
    strains = np.zeros((structure.elements, 6, q.shape[1]))
    for joint, block in zip(structure.ordered_joints, np.split(q, len(structure.joints)), strict=True):
        component, sense = AXES[joint]
        strains[:, component] = sense * block
    return strains


def turns(structure: Structure, omega: Array, modes: Array) -> Turns:
    """The kernel of modes (n, k) at the frequencies `omega` (k,)."""
    beam, count = chain(structure), len(omega)
    after, before = joint_velocities(beam)
    differences = (after - before).reshape(6 * beam.elements, -1)
    strains = strains_of(structure, modes / omega)
    velocities = np.asarray(np.linalg.solve(differences, omega * strains.reshape(-1, count)), np.float64)
    momenta = _momenta(beam, velocities)
    forces = np.asarray(np.linalg.solve(differences.T, omega * momenta), np.float64)
    strained = strain_products(0.5 * (after + before), strains, velocities)
    of_strains = np.einsum("njs,njli->sil", forces.reshape(-1, 6, count), strained)
    spun = _turned(velocities, momenta)
    found = [
        (count + s, i, count + by, of_strains[s, i, by]) for s, i, by in np.ndindex(of_strains.shape)
    ] + [(i, j, by, spun[i, j, by]) for i, j, by in np.ndindex(spun.shape) if i < j]
    largest = max((abs(weight) for *_, weight in found), default=0.0)
    kept = [turn for turn in found if abs(turn[3]) > ROUNDING * largest]
    return Turns(
        omega=np.array(omega),
        pairs=np.array([turn[:3] for turn in kept], dtype=np.int64).reshape(-1, 3),
        weights=np.array([turn[3] for turn in kept]),
    )


def _rigid(to: Array) -> Array:
    """(N, 6, 6) the velocity (V, Ω) of a rigid body at `to` (N, 3), from that at 0: V + Ω × to."""
    moved = np.tile(np.eye(6), (len(to), 1, 1))
    moved[:, :3, 3:] = -crosses(to)
    return moved


def _momenta(beam: Chain, velocities: Array) -> Array:
    """(6 N, k) M v: of each element linear and angular."""
    v = velocities.reshape(beam.elements, 6, -1)
    spins = np.zeros_like(v[:, 3:]) if beam.tensors is None else beam.tensors @ v[:, 3:]
    return np.concatenate([beam.masses[:, None, None] * v[:, :3], spins], axis=1).reshape(velocities.shape)


def _turned(velocities: Array, momenta: Array) -> Array:
    """(k, k, k), skew in the first two: the forces −Ω × p on mode i of modes j and l, Γ₁.

    Of linear momenta the skew pair are the two velocities, of angular ones the two turns:
    −V_i · Ω_l × m V_j and −Ω_i · Ω_j × I Ω_l.
    """
    count = velocities.shape[1]
    v, p = velocities.reshape(-1, 6, count), momenta.reshape(-1, 6, count)
    carried = np.cross(v[:, 3:, :, None], p[:, :3, None, :], axis=1)
    spun = np.cross(v[:, 3:, :, None], p[:, 3:, None, :], axis=1)
    of_linear = np.einsum("nci,nclj->ijl", v[:, :3], carried)
    return np.asarray(-of_linear - np.einsum("nci,ncjl->ijl", v[:, 3:], spun))
