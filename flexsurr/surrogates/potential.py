"""A potential V(q) that is no quadratic form: weight, springs that harden, any equilibrium.

Its force −∇V is the exact gradient, so a model that has it beside a mass matrix and dampers stays passive:
with H = ½ pᵀ M⁻¹ p + V still dH/dt = −q̇ᵀ C q̇ ≤ 0.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from flexsurr.simulation.jacobian import implements_jacobian, jacobian
from flexsurr.simulation.mapping import mapping, mapping_jacobian
from flexsurr.simulation.rhs import Array, implements_rhs, rhs
from flexsurr.surrogates.learned_map import Intervals
from flexsurr.surrogates.monomials import Exponents, differentiate, evaluate_monomials
from flexsurr.surrogates.polynomial_map import PolynomialMap


@dataclass(frozen=True, eq=False)
class Potential:
    """V̂(q̂) = Σ_k c_k φ_k(q̂) with monomials φ of `exponents` (count, r), none of them constant: V̂(0) = 0."""

    exponents: Exponents
    coefficients: Array  # (count,)

    def __post_init__(self) -> None:
        if self.exponents.ndim != 2 or self.exponents.sum(axis=1).min(initial=1) < 1:
            raise ValueError("the monomials of a potential have degree 1 or more")
        if self.coefficients.shape != (len(self.exponents),):
            raise ValueError(
                f"a potential of {len(self.exponents)} monomials has as many coefficients, "
                f"not shape {self.coefficients.shape}"
            )

    @cached_property
    def gradient_terms(self) -> tuple[Exponents, Array]:
        """Monomials (m, r) and coefficients (m, r) of ∂V̂/∂q̂."""
        lowered, tensor = differentiate(self.exponents)
        return lowered, np.einsum("jmi,i->mj", tensor, self.coefficients)

    def value(self, q: Array) -> Array:
        """V̂ at scaled coordinates, (..., r) -> (...)."""
        return np.asarray(evaluate_monomials(self.exponents, q) @ self.coefficients)

    def gradient(self, q: Array) -> Array:
        """∂V̂/∂q̂ at scaled coordinates, (..., r) -> (..., r)."""
        lowered, coefficients = self.gradient_terms
        return np.asarray(evaluate_monomials(lowered, q) @ coefficients)

    def split(self) -> tuple[Array, "Potential"]:
        """Springs K̂ (r, r), positive semidefinite, and the rest: V̂ is ½ q̂ᵀ K̂ q̂ and the rest together."""
        r, coefficients = self.exponents.shape[1], self.coefficients.copy()
        hessian = np.zeros((r, r))
        square = self.exponents.sum(axis=1) == 2
        for exponents, coefficient in zip(self.exponents[square], coefficients[square], strict=True):
            i, j = np.repeat(np.arange(r), exponents)
            hessian[i, j] += coefficient
            hessian[j, i] += coefficient
        values, vectors = np.linalg.eigh(hessian)
        springs = (vectors * np.maximum(values, 0.0)) @ vectors.T
        for k in np.flatnonzero(square):
            i, j = np.repeat(np.arange(r), self.exponents[k])
            coefficients[k] -= springs[i, j] * (0.5 if i == j else 1.0)
        return springs, Potential(self.exponents, coefficients)

    def arrays_to_keep(self) -> dict[str, np.ndarray]:
        """What a file holds of it."""
        return {"potential_exponents": self.exponents, "potential_coefficients": self.coefficients}

    @classmethod
    def kept(cls, arrays: Mapping[str, np.ndarray]) -> "Potential | None":
        """That of a file's arrays, or None where there is none."""
        if "potential_exponents" not in arrays:
            return None
        exponents = arrays["potential_exponents"].astype(np.int64, casting="safe")
        return cls(exponents, arrays["potential_coefficients"])

    def beside(
        self, model: NamedTuple, work_size: int, of_q: Array, of_forces: Array
    ) -> tuple[NamedTuple, int]:
        """The kernel of a model with this potential besides, for scales (r,) of q and of ṗ; its workspace."""
        lowered, coefficients = self.gradient_terms
        names = tuple(f"q_{k + 1}" for k in range(of_q.size))
        gradient = PolynomialMap(
            Intervals(names, -of_q, of_q), names, lowered, coefficients * of_forces
        ).compiled()
        # rates of the model or the Hessian, and what either of the two needs
        r = of_q.size
        return PotentialKernel(model, gradient.kernel), (2 + r) * r + max(work_size, gradient.work_size)


class PotentialKernel(NamedTuple):
    """A model's kernel, and the mapping from q to ∂V/∂q."""

    model: Any
    gradient: Any


@implements_rhs(PotentialKernel, inline=False)
def _with_potential(kernel, t, x, dx, work):
    rhs(kernel.model, t, x, dx, work)
    r = x.size // 2
    mapping(kernel.gradient, x[:r], work[:r], work[r:])
    for i in range(r):
        dx[r + i] -= work[i]


@implements_jacobian(PotentialKernel)
def _jacobian_with_potential(kernel, t, x, dx, jac, work):
    d = x.size
    r = d // 2
    rates = work[:d]
    mapping(kernel.gradient, x[:r], rates[r:], work[d:])
    for i in range(r):
        rates[i] = dx[i]
        rates[r + i] += dx[r + i]
    taken = jacobian(kernel.model, t, x, rates, jac, work[d:])
    hessian = work[: r * r]
    mapping_jacobian(kernel.gradient, x[:r], hessian, work[r * r :])
    for i in range(r):
        for j in range(r):
            jac[r + i, j] -= hessian[i * r + j]
    return taken
