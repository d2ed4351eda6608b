"""A polynomial Hamiltonian's coefficients by linear least squares on the field.

Hamilton's equations are linear in H, so a polynomial's coefficients need no iteration: the columns are
the fields of the single monomials. Rows are reduced by QR piece by piece, which bounds the memory
without squaring the condition number as normal equations would; the small triangle is solved by
pivoted QR, its columns normalised.

Terms that a structure does not have only cost time and accuracy, so subsets are tried too: with
kinetic energy quadratic in p (every mechanical system), and even in q (symmetric structures). The one
with the fewest terms among those that validate about as well as the best is kept.
"""

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import PolynomialHamiltonian, canonical_scaling
from flexsurr.surrogates.monomials import (
    Exponents,
    differentiate,
    evaluate_monomials,
    monomials_to_degree,
)
from flexsurr.surrogates.surrogate import symplectic
from flexsurr.training.dataset import Dataset
from flexsurr.training.losses import nmse, output_weights
from flexsurr.training.triangle import Triangle

CHUNK = 1 << 21  # elements of the matrix that exist at a time: 16 MB
AS_GOOD = 2.0  # losses within this factor of the least count as equal


def fit_polynomial(dataset: Dataset, degree: int) -> PolynomialHamiltonian:
    """The polynomial Hamiltonian of total degree ≤ `degree` with the least nmse on the training samples.

    Raises ValueError where the samples don't vary, and LinAlgError where they are not finite.
    """
    scaling = canonical_scaling(dataset.scales)
    count = len(dataset.state_names)
    exponents = monomials_to_degree(count, degree)
    triangle = _reduced(
        exponents,
        dataset.x_train / scaling.states(count),
        dataset.dx_train / scaling.rates(count),
    )
    candidates = []
    for chosen in _subsets(exponents):
        polynomial = PolynomialHamiltonian(
            triangle.solve(chosen),
            scaling,
            dataset.state_names,
            dataset.state_units,
            exponents[chosen],
        )
        loss = nmse(polynomial.derivative(0.0, dataset.x_validation), dataset.dx_validation)
        candidates.append((loss, polynomial))
    least = min(loss for loss, _ in candidates)
    return min(
        (polynomial for loss, polynomial in candidates if loss <= AS_GOOD * least),
        key=lambda polynomial: polynomial.parameter_count,
    )


def _subsets(exponents: Exponents) -> list[NDArray[np.bool_]]:
    """Masks of all monomials, of those of a mechanical system, and of both kinds' even ones."""
    r = exponents.shape[1] // 2
    in_q, in_p = exponents[:, :r].sum(axis=1), exponents[:, r:].sum(axis=1)
    everything = np.ones(len(exponents), dtype=np.bool_)
    mechanical = (in_p == 0) | (in_p == 2)
    even = (in_q % 2 == 0) & (in_p % 2 == 0)
    return [everything, even, mechanical, mechanical & even]


def _reduced(exponents: Exponents, x: Array, y: Array) -> Triangle:
    """Of the matrix [fields of the monomials, y], both weighted."""
    d = x.shape[1]
    lower, tensor = differentiate(exponents)
    roots = np.sqrt(output_weights(y) / len(x))
    step = max(CHUNK // (d * (len(exponents) + 1)), 1)
    triangle = Triangle(len(exponents))
    for first in range(0, len(x), step):
        part = slice(first, first + step)
        # (samples, monomial, d): the field of each monomial
        fields = symplectic(
            np.einsum("sk,jki->sij", evaluate_monomials(lower, x[part]), tensor, optimize=True)
        )
        rows = np.concatenate([fields, y[part, None, :]], axis=1) * roots
        rows = rows.transpose(0, 2, 1).reshape(-1, len(exponents) + 1)
        triangle.add(rows)
    return triangle
