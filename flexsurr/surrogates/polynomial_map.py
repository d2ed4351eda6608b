"""Learned maps as polynomials, in NumPy and compiled."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.mapping import CompiledMapping, implements_mapping, implements_mapping_jacobian
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.layers import offset
from flexsurr.surrogates.learned_map import Intervals
from flexsurr.surrogates.monomials import (
    Exponents,
    differentiate,
    evaluate_monomials,
    factors,
    pull_back,
    runs,
    write_monomials,
)


@dataclass(frozen=True, eq=False)
class PolynomialMap:
    """Σ c φ(scaled inputs): monomials φ of `exponents` (count, n), the constant first; c (count, k)."""

    inputs: Intervals
    output_names: tuple[str, ...]
    exponents: Exponents
    coefficients: Array

    kind: ClassVar[str] = "polynomial"

    def __post_init__(self) -> None:
        factors(self.exponents)
        if self.exponents.shape[1] != len(self.inputs.names):
            raise ValueError(f"an exponent for each of {', '.join(self.inputs.names)}")
        if self.coefficients.shape != (len(self.exponents), len(self.output_names)):
            raise ValueError(
                f"{self.coefficients.shape} coefficients do not fit {len(self.exponents)} monomials and the"
                f" outputs {', '.join(self.output_names)}"
            )

    def __call__(self, u: Array) -> Array:
        """Outputs at inputs, (..., n) -> (..., k)."""
        return evaluate_monomials(self.exponents, self.inputs.scaled(u)) @ self.coefficients

    @cached_property
    def _derivative(self) -> tuple[Exponents, Array]:
        lowered, tensor = differentiate(self.exponents)
        return lowered, np.einsum("kli,im->lmk", tensor, self.coefficients) / self.inputs.half

    def jacobian(self, u: Array) -> Array:
        """∂(outputs)/∂(inputs), (..., n) -> (..., k, n)."""
        lowered, coefficients = self._derivative
        monomials = evaluate_monomials(lowered, self.inputs.scaled(u))
        slopes: Array = np.einsum("...l,lmk->...mk", monomials, coefficients)
        return slopes

    @property
    def form(self) -> str:
        """Its degree."""
        powers = self.exponents.sum(axis=1)
        return f"degree {powers.max()}{'' if np.any(powers % 2) else ', even'}"

    @property
    def parameter_count(self) -> int:
        """Coefficients of all outputs."""
        return self.coefficients.size

    def compiled(self) -> CompiledMapping:
        """Monomials as products, then a sum for each output."""
        order, pieces = runs(self.exponents)
        n = len(self.inputs.names)
        kernel = PolynomialMapKernel(
            self.inputs.origin,
            1.0 / self.inputs.half,
            pieces,
            np.ascontiguousarray(self.coefficients[order].T).ravel(),
        )
        # factors and monomials, and what the Jacobian needs besides, as much again
        work_size = n * (n + 3) + 2 * len(self.exponents)
        return CompiledMapping(kernel, work_size, self.inputs.names, self.output_names)

    def settings(self) -> dict[str, Any]:
        """Nothing: a polynomial is its arrays."""
        return {}

    def arrays(self) -> dict[str, np.ndarray]:
        """Exponents and coefficients."""
        return {"exponents": self.exponents, "coefficients": self.coefficients}


class PolynomialMapKernel(NamedTuple):
    """Monomials of (u − origin) times `inverse` (n,), as `write_monomials` makes them of `pieces`.

    `coefficients` holds those of the first output, then those of the next.
    """

    origin: Array
    inverse: Array
    pieces: NDArray[np.uint64]
    coefficients: Array


@implements_mapping(PolynomialMapKernel)
def _polynomial_map(kernel, u, y, work):
    origin, inverse, pieces, coefficients = kernel
    n = offset(origin.size)
    count = offset(coefficients.size // y.size)
    phi = n + n * (n + offset(1)) // offset(2)
    for i in range(n):
        work[i] = (u[i] - origin[i]) * inverse[i]
    write_monomials(pieces, n, phi, work)
    for i in range(offset(y.size)):
        total = 0.0
        row = i * count
        for k in range(count):
            total += coefficients[row + k] * work[phi + k]
        y[i] = total


@implements_mapping_jacobian(PolynomialMapKernel)
def _jacobian_of_polynomial_map(kernel, u, jac, work):
    origin, inverse, pieces, coefficients = kernel
    n = offset(origin.size)
    outputs = offset(jac.size) // n
    count = offset(coefficients.size) // outputs
    # work: factors and monomials, their derivatives
    size = n + n * (n + offset(1)) // offset(2)
    phi = size
    adjoint = phi + count
    slopes = adjoint + count
    for i in range(n):
        work[i] = (u[i] - origin[i]) * inverse[i]
    write_monomials(pieces, n, phi, work)
    for i in range(outputs):
        for k in range(count):
            work[adjoint + k] = coefficients[i * count + k]
        pull_back(pieces, n, phi, adjoint, slopes, work)
        for j in range(n):
            jac[i * n + j] = work[slopes + j] * inverse[j]
