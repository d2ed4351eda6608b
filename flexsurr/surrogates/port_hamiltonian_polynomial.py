"""Port-Hamiltonian surrogate with a polynomial mass matrix: linear in its parameters but for damping."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.jacobian import implements_jacobian
from flexsurr.simulation.linear_solvers import invert_packed, solve_packed
from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.surrogates.layers import offset
from flexsurr.surrogates.monomials import (
    Exponents,
    differentiate,
    evaluate_monomials,
    factors,
    pull_back,
    runs,
    write_hessian,
    write_monomials,
)
from flexsurr.surrogates.packed import lower, symmetric
from flexsurr.surrogates.port_hamiltonian import (
    PortHamiltonian,
    jacobian_of_motion,
    springs_and_dampers,
    write_kinetic_adjoint,
)
from flexsurr.surrogates.sparse_mass import looking_up_pays, sparse_kernel


@dataclass(frozen=True, eq=False)
class PolynomialPortHamiltonian(PortHamiltonian):
    """M̂(q̂) = Σ_k A_k φ_k(q̂) with monomials φ of `exponents` (count, r), the constant first.

    `parameters` holds the packed entries of all A, entry by entry, then K̂, then the factor L of Ĉ = L Lᵀ.
    Nothing keeps such a matrix positive definite far from where it was fitted: there the field is not a
    number, and a simulation that gets there ends.
    """

    exponents: Exponents

    def __post_init__(self) -> None:
        shape = self.exponents.shape
        if len(shape) != 2 or shape[1] != self.pairs or self.exponents.min(initial=0) < 0:
            raise ValueError(
                f"exponents must be whole numbers ≥ 0, a column for each coordinate, not {shape}"
            )
        factors(self.exponents)
        super().__post_init__()

    @property
    def parameter_count(self) -> int:
        """Coefficients of every entry of M, and the entries of K and of the factor of C."""
        return self.packed_size * (len(self.exponents) + 2)

    @property
    def degree(self) -> int:
        """Highest total degree."""
        return int(self.exponents.sum(axis=1).max())

    @cached_property
    def _coefficients(self) -> Array:
        """(entry of M, monomial)."""
        return self.parameters[: -2 * self.packed_size].reshape(self.packed_size, -1)

    @property
    def scaled_stiffness(self) -> Array:
        """K̂ (r, r)."""
        return symmetric(self.parameters[-2 * self.packed_size : -self.packed_size], self.pairs)

    @property
    def scaled_damping(self) -> Array:
        """Ĉ (r, r)."""
        factor = lower(self.parameters[-self.packed_size :], self.pairs)
        return factor @ factor.T

    def scaled_mass(self, q: Array) -> Array:
        """M̂ at scaled coordinates, (..., r) -> (..., r, r)."""
        return symmetric(evaluate_monomials(self.exponents, q) @ self._coefficients.T, self.pairs)

    @cached_property
    def _derivative(self) -> tuple[Exponents, Array]:
        """Monomials and coefficients (r, entry, monomial) of ∂M̂/∂q̂."""
        lowered, tensor = differentiate(self.exponents)
        return lowered, np.einsum("kmi,ei->kem", tensor, self._coefficients)

    def scaled_mass_derivatives(self, q: Array) -> Array:
        """∂M̂/∂q̂_k, (..., r) -> (..., r, r, r) with k first."""
        lowered, coefficients = self._derivative
        monomials = evaluate_monomials(lowered, q)
        return symmetric(np.einsum("kem,...m->...ke", coefficients, monomials), self.pairs)

    def own_kernel(self) -> tuple[NamedTuple, int]:
        """Monomials as products, their adjoints for the gyroscopic term, and a small system.

        Where most of many coefficients are zero, entries of M with the same monomials are made together, of
        those alone.
        """
        _, of_q, of_p, of_rates = self.scales()
        rows, columns = np.tril_indices(self.pairs)
        order, pieces = runs(self.exponents)
        unscaled = self._coefficients[:, order] * (of_p[rows] / of_rates[columns])[:, None]
        if looking_up_pays(unscaled):
            return sparse_kernel(1.0 / of_q, pieces, unscaled, self.stiffness, self.damping)
        kernel = PolynomialPortHamiltonianKernel(
            1.0 / of_q,
            pieces,
            np.ascontiguousarray(unscaled).ravel(),
            np.ascontiguousarray(self.stiffness).ravel(),
            np.ascontiguousarray(self.damping).ravel(),
        )
        size, count = self.pairs + self.packed_size, len(self.exponents)
        # of the right-hand side, and what its Jacobian needs besides
        return kernel, 3 * size + 2 * count + 3 * self.pairs**2 + 2 * size + 2 * count

    def settings(self) -> dict[str, Any]:
        """Nothing: the exponents are saved as an array."""
        return {}

    def arrays_to_keep(self) -> dict[str, np.ndarray]:
        """Coefficients and exponents."""
        return {**super().arrays_to_keep(), "exponents": self.exponents}


class PolynomialPortHamiltonianKernel(NamedTuple):
    """Monomials of q times `inverse_q` (r,), as `write_monomials` makes them of `pieces`.

    `mass` holds the coefficients of the packed M, entry by entry; `stiffness` and `damping` are (r, r) row by
    row.
    """

    inverse_q: Array
    pieces: NDArray[np.uint64]
    mass: Array
    stiffness: Array
    damping: Array


@implements_rhs(PolynomialPortHamiltonianKernel, inline=False)
def _polynomial_port_hamiltonian(kernel, t, x, dx, work):
    inverse_q, pieces, mass, stiffness, damping = kernel
    r = offset(inverse_q.size)
    entries = r * (r + offset(1)) // offset(2)
    count = offset(mass.size) // entries
    # work: factors and their adjoints, monomials and theirs, the packed M, the rates
    slopes = r + entries
    phi = slopes + r + entries
    adjoint = phi + count
    matrix = adjoint + count
    rates = matrix + entries
    for i in range(r):
        work[i] = x[i] * inverse_q[i]
    write_monomials(pieces, r, phi, work)
    # two entries at a time: half the loads of monomials and, below, of their adjoints
    odd = entries % offset(2)
    for e in range(offset(0), entries - odd, offset(2)):
        total = 0.0
        other = 0.0
        row = e * count
        for k in range(count):
            total += mass[row + k] * work[phi + k]
            other += mass[row + count + k] * work[phi + k]
        work[matrix + e] = total
        work[matrix + e + offset(1)] = other
    if odd:
        total = 0.0
        row = (entries - odd) * count
        for k in range(count):
            total += mass[row + k] * work[phi + k]
        work[matrix + entries - odd] = total
    for i in range(r):
        work[rates + i] = x[r + i]
    solve_packed(work, np.int64(matrix), np.int64(rates), np.int64(r))
    for i in range(r):
        dx[i] = work[rates + i]
    # the adjoint of ½ q̇ᵀ M q̇: by the entries of M, in their places; by the monomials; by q
    write_kinetic_adjoint(dx, r, work, matrix)
    for k in range(count):
        work[adjoint + k] = 0.0
    for e in range(offset(0), entries - odd, offset(2)):
        weight = work[matrix + e]
        other = work[matrix + e + offset(1)]
        row = e * count
        for k in range(count):
            work[adjoint + k] += weight * mass[row + k] + other * mass[row + count + k]
    if odd:
        weight = work[matrix + entries - odd]
        row = (entries - odd) * count
        for k in range(count):
            work[adjoint + k] += weight * mass[row + k]
    pull_back(pieces, r, phi, adjoint, slopes, work)
    for i in range(r):
        dx[r + i] = work[slopes + i] * inverse_q[i]
    springs_and_dampers(stiffness, damping, x, dx)


@implements_jacobian(PolynomialPortHamiltonianKernel)
def _jacobian_of_polynomial(kernel, t, x, dx, jac, work):
    inverse_q, pieces, mass, stiffness, damping = kernel
    r = offset(inverse_q.size)
    entries = r * (r + offset(1)) // offset(2)
    count = offset(mass.size) // entries
    # work: as of the right-hand side, then M⁻¹, (∂M/∂q_k) q̇ column by column, curvature, tangents
    slopes = r + entries
    phi = slopes + r + entries
    adjoint = phi + count
    matrix = adjoint + count
    inverse = matrix + entries
    turned = inverse + r * r
    curvature = turned + r * r
    tangents = curvature + r * r
    for i in range(r):
        work[i] = x[i] * inverse_q[i]
    write_monomials(pieces, r, phi, work)
    for e in range(entries):
        total = 0.0
        for k in range(count):
            total += mass[e * count + k] * work[phi + k]
        work[matrix + e] = total
    invert_packed(work, np.int64(matrix), np.int64(inverse), np.int64(r))
    # row i of M q̇, with q̇ held, is a polynomial
    for i in range(r):
        for k in range(count):
            work[adjoint + k] = 0.0
        for j in range(r):
            low = min(i, j)
            high = max(i, j)
            row = (high * (high + offset(1)) // offset(2) + low) * count
            for k in range(count):
                work[adjoint + k] += dx[j] * mass[row + k]
        pull_back(pieces, r, phi, adjoint, slopes, work)
        for k in range(r):
            work[turned + i * r + k] = work[slopes + k] * inverse_q[k]
    # and so is ½ q̇ᵀ M q̇
    for k in range(count):
        work[adjoint + k] = 0.0
    write_kinetic_adjoint(dx, r, work, matrix)
    for e in range(entries):
        weight = work[matrix + e]
        for k in range(count):
            work[adjoint + k] += weight * mass[e * count + k]
    pull_back(pieces, r, phi, adjoint, slopes, work)
    write_hessian(pieces, r, phi, adjoint, slopes, inverse_q, curvature, tangents, work)
    jacobian_of_motion(stiffness, damping, work, inverse, turned, curvature, jac)
    return 0
