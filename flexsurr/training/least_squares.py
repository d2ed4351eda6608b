"""Linear least squares over any number of rows, and by it a polynomial Hamiltonian's coefficients.

Hamilton's equations are linear in H, so a polynomial's coefficients need no iteration: the columns are
the fields of the single monomials.

Terms that a structure does not have only cost time and accuracy, so subsets are tried too: with
kinetic energy quadratic in p (every mechanical system), and even in q (symmetric structures). The one
with the fewest terms among those that validate about as well as the best is kept.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq
from scipy.linalg.lapack import dtpqrt

from flexsurr.simulation.rhs import Array
from flexsurr.storage import Scales
from flexsurr.surrogates import PolynomialHamiltonian, Scaling, canonical_scaling
from flexsurr.surrogates.monomials import (
    Exponents,
    differentiate,
    evaluate_monomials,
    monomials_to_degree,
)
from flexsurr.surrogates.surrogate import symplectic
from flexsurr.training.dataset import SampleSource, for_each_piece
from flexsurr.training.losses import FieldErrors, as_good, weights_of_variance

PANEL = 32  # columns that LAPACK takes at a time, as many as where it may choose


class Triangle:
    """The R factor of the rows [matrix, targets] seen so far; the matrix has `unknowns` columns.

    It is what the next block of rows is joined to (the sequential tall-skinny QR of Demmel, Grigori, Hoemmen
    & Langou, SIAM J. Sci. Comput. 34, 2012, by LAPACK's QR of a triangle on rows, which knows the zeros):
    memory is bounded, and the condition number is not squared as normal equations would.
    """

    def __init__(self, unknowns: int, targets: int = 1) -> None:
        self._unknowns = unknowns
        self._triangle = np.zeros((unknowns + targets, unknowns + targets), order="F")

    def add(self, rows: Array) -> None:
        """Join `rows` (m, unknowns + targets), the targets last. ValueError where they are not finite."""
        rows = np.array(np.asarray_chkfinite(rows), order="F")
        panel = min(PANEL, len(self._triangle))
        self._triangle, *_ = dtpqrt(0, panel, self._triangle, rows, overwrite_a=True, overwrite_b=True)

    def solve(self, chosen: NDArray[np.bool_] | None = None) -> Array:
        """The solution in the `chosen` unknowns (a mask; by default all), the others being zero and left out.

        A vector for one target, for several a column each. Rank-revealing: pivoted QR with normalised
        columns; what the rows leave undetermined is kept small.
        """
        matrix, targets = np.split(self._triangle, [self._unknowns], axis=1)
        if chosen is not None:
            matrix = matrix[:, chosen]
        norms = np.linalg.norm(matrix, axis=0)
        norms[norms == 0.0] = 1.0
        threshold = np.finfo(np.float64).eps * len(norms)
        solution, *_ = lstsq(matrix / norms, targets, cond=threshold, lapack_driver="gelsy")
        solution = solution / norms[:, None]
        found: Array = solution[:, 0] if solution.shape[1] == 1 else solution
        return found


CHUNK = 1 << 21  # elements of the matrix that exist at a time: 16 MB


def fit_polynomial(source: SampleSource, degree: int) -> PolynomialHamiltonian:
    """The polynomial Hamiltonian of total degree ≤ `degree` with the least nmse on the training samples.

    Samples are read twice, block by block. Raises ValueError where they don't vary or are not finite.
    """
    problem = HamiltonEquations(degree, canonical_scaling(source.scales), source.scales)
    for_each_piece(source.training_blocks(), problem.add)
    candidates = [
        problem.solve(chosen, source.state_names, source.state_units)
        for chosen in _subsets(problem.exponents)
    ]
    errors = [FieldErrors(candidate) for candidate in candidates]
    for_each_piece(source.validation_blocks(), *(error.add for error in errors))
    losses = [error.nmse() for error in errors]
    return min(
        (
            polynomial
            for loss, polynomial in zip(losses, candidates, strict=True)
            if as_good(loss, min(losses))
        ),
        key=lambda polynomial: polynomial.parameter_count,
    )


class HamiltonEquations:
    """The least-squares problem for monomials up to `degree`, fed block by block.

    Each state's rate counts relative to its variance, which `scales` know. Memory is that of one block and
    of a triangle of the unknowns, however many samples there are.
    """

    def __init__(self, degree: int, scaling: Scaling, scales: Scales) -> None:
        self.scaling = scaling
        deviations = np.split(np.array(scales.standard_deviation), 2)[1]
        self._count = deviations.size
        self._rates = scaling.rates(self._count)
        self._roots = np.sqrt(weights_of_variance((deviations / self._rates) ** 2))
        self.exponents = monomials_to_degree(self._count, degree)
        self._lowered, self._derivative = differentiate(self.exponents)
        self._triangle = Triangle(len(self.exponents))

    def add(self, x: Array, dx: Array) -> None:
        """Samples of states `x` and derivatives `dx` (m, 2r) in their units."""
        x, y = x / self.scaling.states(self._count), dx / self._rates
        step = max(CHUNK // (self._count * (len(self.exponents) + 1)), 1)
        for first in range(0, len(x), step):
            self._triangle.add(self._rows(x[first : first + step], y[first : first + step]))

    def _rows(self, x: Array, y: Array) -> Array:
        """[fields of the monomials, y] of scaled samples, both weighted: (m · 2r, count + 1)."""
        # (samples, monomial, 2r): the field of each monomial
        fields = symplectic(
            np.einsum("sk,jki->sij", evaluate_monomials(self._lowered, x), self._derivative, optimize=True)
        )
        rows = np.concatenate([fields, y[:, None, :]], axis=1) * self._roots
        return rows.transpose(0, 2, 1).reshape(-1, len(self.exponents) + 1)

    def solve(
        self, chosen: NDArray[np.bool_], state_names: tuple[str, ...], state_units: tuple[str, ...]
    ) -> PolynomialHamiltonian:
        """The fitted surrogate with the `chosen` monomials (a mask) alone."""
        coefficients = self._triangle.solve(chosen)
        return PolynomialHamiltonian(
            coefficients, self.scaling, state_names, state_units, self.exponents[chosen]
        )


def _subsets(exponents: Exponents) -> list[NDArray[np.bool_]]:
    """Masks of all monomials, of those of a mechanical system, and of both kinds' even ones."""
    r = exponents.shape[1] // 2
    in_q, in_p = exponents[:, :r].sum(axis=1), exponents[:, r:].sum(axis=1)
    everything = np.ones(len(exponents), dtype=np.bool_)
    mechanical = (in_p == 0) | (in_p == 2)
    even = (in_q % 2 == 0) & (in_p % 2 == 0)
    return [everything, even, mechanical, mechanical & even]
