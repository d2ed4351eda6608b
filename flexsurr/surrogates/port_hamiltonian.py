"""Port-Hamiltonian surrogates: ẋ = (J − R) ∇H + G u, passive whatever their parameters.

    H = ½ pᵀ M⁻¹(q) p + ½ qᵀ K q,   J = [0 I; −I 0],   R = blockdiag(0, C),   C = L Lᵀ,   G = [0; I]

so that q̇ = M⁻¹ p and ṗ = ½ ∂/∂q (q̇ᵀ M q̇) − K q − C q̇ + u, and with no load dH/dt = −q̇ᵀ C q̇ ≤ 0 (van der
Schaft & Jeltsema, *Port-Hamiltonian Systems Theory*, 2014, ch. 6). The mass matrix is what is learned, not
its inverse: with measured q̇ the equations are linear in M, K and C.

½ qᵀ K q knows no weight, and no equilibrium but the origin. A `Potential` V(q) beside it does.
"""

from abc import abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.layers import offset
from flexsurr.surrogates.packed import OPTIONS, packed_size
from flexsurr.surrogates.potential import Potential
from flexsurr.surrogates.scaling import FeatureScaling
from flexsurr.surrogates.surrogate import Surrogate


@dataclass(frozen=True, eq=False)
class PortHamiltonian(Surrogate):
    """A subclass has a mass matrix; r is the number of pairs (q, p). Everything here is in scaled states."""

    potential: Potential | None = field(default=None, kw_only=True)

    architecture: ClassVar[str] = "port_hamiltonian"

    def __post_init__(self) -> None:
        if isinstance(self.scaling, FeatureScaling):
            raise ValueError("a port-Hamiltonian surrogate takes a canonical scaling")
        if self.potential is not None and self.potential.exponents.shape[1] != self.pairs:
            raise ValueError(
                f"a potential of {self.potential.exponents.shape[1]} coordinates for {self.pairs}"
            )
        super().__post_init__()

    @property
    def pairs(self) -> int:
        """Number r of pairs (q, p)."""
        return len(self.state_names) // 2

    @property
    def packed_size(self) -> int:
        """Number of entries of a packed (r, r) matrix."""
        return packed_size(self.pairs)

    @abstractmethod
    def scaled_mass(self, q: Array) -> Array:
        """M̂ at scaled coordinates, (..., r) -> (..., r, r)."""

    @abstractmethod
    def scaled_mass_derivatives(self, q: Array) -> Array:
        """∂M̂/∂q̂_k, (..., r) -> (..., r, r, r) with k first."""

    @property
    @abstractmethod
    def scaled_stiffness(self) -> Array:
        """K̂ (r, r), symmetric."""

    @property
    @abstractmethod
    def scaled_damping(self) -> Array:
        """Ĉ (r, r), symmetric and positive semidefinite."""

    def scaled_field(self, x: Array) -> Array:
        """(J − R) ∇Ĥ."""
        q, p = x[..., : self.pairs], x[..., self.pairs :]
        rates = np.linalg.solve(self.scaled_mass(q), p[..., None])[..., 0]
        gyroscopic = np.einsum("...kij,...i,...j->...k", self.scaled_mass_derivatives(q), rates, rates)
        forces = 0.5 * gyroscopic - q @ self.scaled_stiffness - rates @ self.scaled_damping
        if self.potential is not None:
            forces = forces - self.potential.gradient(q)
        return np.concatenate([rates, forces], axis=-1)

    def scaled_energy(self, x: Array) -> Array:
        """Ĥ of scaled states, (..., 2r) -> (...); zero at the origin."""
        q, p = x[..., : self.pairs], x[..., self.pairs :]
        rates = np.linalg.solve(self.scaled_mass(q), p[..., None])[..., 0]
        energy: Array = 0.5 * np.sum(p * rates, axis=-1) + 0.5 * np.sum(
            q * (q @ self.scaled_stiffness), axis=-1
        )
        return energy if self.potential is None else energy + self.potential.value(q)

    @abstractmethod
    def own_kernel(self) -> tuple[NamedTuple, int]:
        """The compiled form without a potential, and the size of its workspace."""

    def kernel(self) -> tuple[NamedTuple, int]:
        """The compiled form, with the potential's force beside it if there is one."""
        own, work_size = self.own_kernel()
        if self.potential is None:
            return own, work_size
        _, of_q, _, _ = self.scales()
        return self.potential.beside(own, work_size, of_q, self.scaling.energy / of_q)

    def arrays_to_keep(self) -> dict[str, np.ndarray]:
        """Parameters, and the potential if there is one."""
        kept = super().arrays_to_keep()
        return kept if self.potential is None else kept | self.potential.arrays_to_keep()

    def energy(self, x: Array) -> Array:
        """H(x) = H(x) − H(0), (..., 2r) -> (...), in the product of the units of q and p per second."""
        return self.scaling.energy * self.scaled_energy(x / self.scaling.states(len(self.state_names)))

    def mass_matrix(self, q: Array) -> Array:
        """M at coordinates q (..., r), shape (..., r, r): p = M q̇ in the units of the states."""
        _, of_q, of_p, of_rates = self.scales()
        return self.scaled_mass(q / of_q) * of_p[:, None] / of_rates

    @property
    def stiffness(self) -> Array:
        """K (r, r): the restoring force is −K q, in the units of p per second, without a potential's."""
        _, of_q, _, _ = self.scales()
        return self.scaled_stiffness * self.scaling.energy / np.outer(of_q, of_q)

    @property
    def damping(self) -> Array:
        """C (r, r): the dissipative force is −C q̇, in the units of p per second."""
        _, of_q, _, of_rates = self.scales()
        return self.scaled_damping * self.scaling.energy / np.outer(of_q, of_rates)

    def scales(self) -> tuple[int, Array, Array, Array]:
        """2r, and the scales of q, p and q̇ (r,)."""
        count, r = len(self.state_names), self.pairs
        states = self.scaling.states(count)
        return count, states[:r], states[r:], self.scaling.rates(count)[:r]


# Each kernel solves M q̇ = p in lines of its own: as a function, inlined, they slowed two kernels by 15 %.
@njit(cache=True, **OPTIONS)
def write_kinetic_adjoint(rates, r, work, adjoint):
    """∂/∂M of ½ q̇ᵀ M q̇ by the packed entries of M, at `adjoint`; `rates` begins with q̇ (r,)."""
    e = adjoint
    for i in range(r):
        for j in range(i + offset(1)):
            weight = rates[i] * rates[j]
            work[e] = 0.5 * weight if i == j else weight
            e += offset(1)


@njit(cache=True, **OPTIONS)
def jacobian_of_motion(stiffness, damping, work, inverse, turned, curvature, jac):
    """∂ẋ/∂x into jac (2r, 2r), from matrices (r, r) row by row at their offsets in `work`.

    `inverse` is M⁻¹, column k of `turned` (∂M/∂q_k) q̇, `curvature` ½ ∂²/∂q∂q (q̇ᵀ M q̇) with q̇ held. As
    ∂q̇/∂q_k = −M⁻¹ (∂M/∂q_k) q̇ and ∂q̇/∂p = M⁻¹, the rest is the chain rule.
    """
    r = offset(jac.shape[0] // 2)
    for i in range(r):
        for k in range(r):
            total = 0.0
            for j in range(r):
                total -= work[inverse + i * r + j] * work[turned + j * r + k]
            jac[i, k] = total
            jac[i, r + k] = work[inverse + i * r + k]
    for k in range(r):
        for m in range(r):
            by_q = work[curvature + k * r + m] - stiffness[k * r + m]
            by_p = 0.0
            for j in range(r):
                by_rate = work[turned + j * r + k] - damping[k * r + j]
                by_q += by_rate * jac[j, m]
                by_p += by_rate * jac[j, r + m]
            jac[r + k, m] = by_q
            jac[r + k, r + m] = by_p


@njit(cache=True, **OPTIONS)
def springs_and_dampers(stiffness, damping, x, dx):
    """Add −K q − C q̇ to ṗ; both (r, r) row by row, q̇ taken from `dx` (2r,)."""
    r = x.size // 2
    for i in range(r):
        force = dx[r + i]
        for j in range(r):
            force -= stiffness[i * r + j] * x[j] + damping[i * r + j] * dx[j]
        dx[r + i] = force
