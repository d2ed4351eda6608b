"""A port-Hamiltonian surrogate with a polynomial mass matrix by one linear least-squares fit.

With measured rates, both

    M(q) q̇ = p        and        ½ ∂/∂q (q̇ᵀ M(q) q̇) − K q − C q̇ = ṗ

are linear in the coefficients of M, in K and in C. A polynomial M⁻¹ would be no linear problem in K and C
together with the field it makes, and fits far worse.
"""

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.storage import Scales
from flexsurr.surrogates import PairScaling, PolynomialPortHamiltonian, StateScaling, pair_scaling
from flexsurr.surrogates.monomials import (
    Exponents,
    differentiate,
    evaluate_monomials,
    monomials_to_degree,
)
from flexsurr.surrogates.packed import packed_size, semidefinite_factor, symmetric
from flexsurr.training.dataset import SampleSource, for_each_piece
from flexsurr.training.losses import FieldErrors
from flexsurr.training.triangle import Triangle

CHUNK = 1 << 22  # elements of the matrix that exist at a time: 32 MB
AS_GOOD = 2.0  # a smaller set of monomials is kept if it validates within this factor of the larger


class NotPositiveDefinite(Exception):
    """A fitted mass matrix that is not so, where the message says; `surrogate` has it."""

    def __init__(self, surrogate: PolynomialPortHamiltonian, q: Array) -> None:
        place = ", ".join(f"{value:.4g}" for value in q)
        super().__init__(
            f"the mass matrix of degree {surrogate.degree} is not positive definite at q = ({place})"
        )
        self.surrogate = surrogate


class InverseDynamics:
    """The least-squares problem for monomials up to `degree`, fed block by block.

    `spread` (2r,) is that of the channels, scaled: of p for the first equation, of ṗ for the second. Memory
    is that of one block and of a triangle of the unknowns, however many samples there are.
    """

    def __init__(self, degree: int, scaling: PairScaling, spread: Array) -> None:
        self.scaling, self._spread = scaling, spread
        self.pairs = len(scaling.q)
        constant = np.zeros((1, self.pairs), dtype=np.int64)
        self.exponents: Exponents = np.concatenate([constant, monomials_to_degree(self.pairs, degree)])
        self._lowered, self._derivative = differentiate(self.exponents)
        self._entries = packed_size(self.pairs)
        self._triangle = Triangle(self._entries * (len(self.exponents) + 2))

    def add(self, x: Array, dx: Array) -> None:
        """Samples of states `x` and derivatives `dx` (m, 2r) in their units."""
        count = 2 * self.pairs
        x, dx = x / self.scaling.states(count), dx / self.scaling.rates(count)
        step = max(CHUNK // (count * self._entries * (len(self.exponents) + 2)), 1)
        for first in range(0, len(x), step):
            self._triangle.add(self._rows(x[first : first + step], dx[first : first + step]))

    def _rows(self, x: Array, dx: Array) -> Array:
        """Rows of the matrix and their target for scaled samples, divided by the channels' spread."""
        r, samples = self.pairs, len(x)
        q, p, rates, forces = x[:, :r], x[:, r:], dx[:, :r], dx[:, r:]
        # what a packed symmetric matrix S gives: S v, and ½ vᵀ S v
        units = symmetric(np.eye(self._entries), r)
        of_rates = np.einsum("eij,sj->sie", units, rates)
        of_q = np.einsum("eij,sj->sie", units, q)
        kinetic = 0.5 * np.einsum("eij,si,sj->se", units, rates, rates)
        monomials = evaluate_monomials(self.exponents, q)
        slopes = np.einsum(
            "sm,kmi->ski", evaluate_monomials(self._lowered, q), self._derivative, optimize=True
        )
        rows = np.zeros((samples, 2 * r, self._entries * (len(self.exponents) + 2) + 1))
        mass = rows[..., : -2 * self._entries - 1].reshape(samples, 2 * r, self._entries, -1)
        mass[:, :r] = of_rates[..., None] * monomials[:, None, None, :]
        mass[:, r:] = kinetic[:, None, :, None] * slopes[:, :, None, :]
        rows[:, r:, -2 * self._entries - 1 : -self._entries - 1] = -of_q
        rows[:, r:, -self._entries - 1 : -1] = -of_rates
        rows[:, :r, -1], rows[:, r:, -1] = p, forces
        rows /= self._spread[:, None]
        return rows.reshape(samples * 2 * r, -1)

    def solve(
        self, even: bool, state_names: tuple[str, ...], state_units: tuple[str, ...]
    ) -> PolynomialPortHamiltonian:
        """The fitted surrogate; `even`: with even powers alone, which is what a symmetric structure has."""
        kept = self.exponents.sum(axis=1) % 2 == 0 if even else np.ones(len(self.exponents), dtype=np.bool_)
        chosen = np.concatenate([np.tile(kept, self._entries), np.ones(2 * self._entries, dtype=np.bool_)])
        solution = self._triangle.solve(chosen)
        # what noise makes of a direction without damping may be slightly negative
        solution[-self._entries :] = semidefinite_factor(symmetric(solution[-self._entries :], self.pairs))
        return PolynomialPortHamiltonian(
            solution, self.scaling, state_names, state_units, self.exponents[kept]
        )


def fit_port_hamiltonian(source: SampleSource, degree: int) -> PolynomialPortHamiltonian:
    """The polynomial port-Hamiltonian surrogate of total degree ≤ `degree` in M, from the training samples.

    Odd powers are kept where they make validation better by a factor of `AS_GOOD`. Samples are read twice,
    block by block. Raises NotPositiveDefinite if its mass matrix is none at a validation state, ValueError
    where the samples don't vary or are not finite.
    """
    scaling = pair_scaling(source.scales)
    problem = InverseDynamics(degree, scaling, channel_spread(scaling, source.scales))
    for_each_piece(source.training_blocks(), problem.add)
    even, full = (
        _Candidate(problem.solve(kind, source.state_names, source.state_units)) for kind in (True, False)
    )
    for_each_piece(source.validation_blocks(), even.add, full.add)
    if even.indefinite_at is not None and full.indefinite_at is not None:
        raise NotPositiveDefinite(even.surrogate, even.indefinite_at)
    return even.surrogate if even.loss() <= AS_GOOD * full.loss() else full.surrogate


class _Candidate:
    """A fitted surrogate as the validation samples show it, block by block."""

    def __init__(self, surrogate: PolynomialPortHamiltonian) -> None:
        self.surrogate = surrogate
        self.indefinite_at: Array | None = None  # the first q (r,) where the mass matrix is no such thing
        self._errors = FieldErrors(surrogate)

    def add(self, x: Array, dx: Array) -> None:
        """Samples of states `x` and derivatives `dx` (m, 2r) in their units."""
        if self.indefinite_at is not None:
            return
        q = x[:, : self.surrogate.pairs]
        positive = is_positive_definite(self.surrogate, q)
        if positive.all():
            self._errors.add(x, dx)
        else:
            self.indefinite_at = q[np.argmin(positive)].copy()  # a view would keep the whole block

    def loss(self) -> float:
        """The nmse; infinite where the mass matrix is not positive definite."""
        return np.inf if self.indefinite_at is not None else self._errors.nmse()


def channel_spread(scaling: StateScaling, scales: Scales) -> Array:
    """Standard deviations (2r,) of the scaled p and ṗ; ValueError where one does not vary."""
    _, momenta, _, forces = np.split(np.array(scales.standard_deviation), 4)
    count, r = 2 * momenta.size, momenta.size
    spread = np.concatenate([momenta / scaling.states(count)[r:], forces / scaling.rates(count)[r:]])
    if not np.all(spread > 0.0):
        raise ValueError(f"p and its derivative must vary over the samples; their spread is {spread}")
    return spread


def is_positive_definite(surrogate: PolynomialPortHamiltonian, q: Array) -> NDArray[np.bool_]:
    """Whether the mass matrix is so at each of the coordinates q (m, r)."""
    smallest = np.linalg.eigvalsh(surrogate.mass_matrix(q))[:, 0]
    positive: NDArray[np.bool_] = smallest > 0.0
    return positive
