"""A port-Hamiltonian surrogate with a polynomial mass matrix by one linear least-squares fit.

With measured rates, both

    M(q) q̇ = p        and        ½ ∂/∂q (q̇ᵀ M(q) q̇) − K q − C q̇ = ṗ

are linear in the coefficients of M, in K and in C. So they are with −∇V(q) in the place of −K q, for a
potential V that is a polynomial. A polynomial M⁻¹ would be no linear problem in K and C
together with the field it makes, and fits far worse. Where M is known at sampled configurations, no rates are
needed: M depends on q alone.
"""

import math

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.storage import Scales
from flexsurr.surrogates import (
    PairScaling,
    PolynomialPortHamiltonian,
    PortHamiltonian,
    StateScaling,
    pair_scaling,
)
from flexsurr.surrogates.monomials import (
    Exponents,
    differentiate,
    evaluate_monomials,
    monomials_to_degree,
)
from flexsurr.surrogates.packed import pack, packed_size, semidefinite_factor, symmetric
from flexsurr.surrogates.potential import Potential
from flexsurr.training.configuration_samples import ConfigurationSamples
from flexsurr.training.dataset import SampleSource, for_each_piece
from flexsurr.training.known_mass import (
    CHUNK,
    SeparateEntries,
    fit_sparse,
    of_degrees,
    of_known_springs,
    with_constant,
)
from flexsurr.training.least_squares import Triangle
from flexsurr.training.losses import FieldErrors, as_good

LARGEST_TOGETHER = 1200  # unknowns of all entries of M that are fitted at once
POTENTIAL_DEGREE = 10
POTENTIAL_MONOMIALS = 400


class NotPositiveDefinite(Exception):
    """A fitted mass matrix that is not so, where the message says; `surrogate` has it."""

    def __init__(self, surrogate: PolynomialPortHamiltonian, q: Array) -> None:
        super().__init__(indefinite(f"of degree {surrogate.degree}", q))
        self.surrogate = surrogate


def indefinite(which: str, q: Array) -> str:
    """In words: that the mass matrix is not positive definite at q (r,), and which one."""
    place = ", ".join(f"{value:.4g}" for value in q)
    return f"the mass matrix {which} is not positive definite at q = ({place})"


class InverseDynamics:
    """The least-squares problem for monomials up to `degree`, fed block by block.

    With a `potential` its coefficients stand where otherwise K does. Errors count relative to the spread of
    the channels: of p in the first equation, of ṗ in the second. Memory is that of one block and of a
    triangle of the unknowns, however many samples there are.
    """

    def __init__(
        self, degree: int, scaling: PairScaling, source: SampleSource, potential: bool = False
    ) -> None:
        self.scaling, self._spread = scaling, channel_spread(scaling, source.scales)
        self._states = source.state_names, source.state_units
        self.pairs = len(scaling.q)
        self.exponents = with_constant(self.pairs, degree)
        self._lowered, self._derivative = differentiate(self.exponents)
        self._entries = packed_size(self.pairs)
        self._springs = _potential_monomials(self.pairs) if potential else None
        # columns of M, of what pulls back, and of C
        pulls = self._entries if self._springs is None else len(self._springs)
        self._columns = np.cumsum([0, self._entries * len(self.exponents), pulls, self._entries])
        self._triangle = Triangle(int(self._columns[-1]))

    def add(self, x: Array, dx: Array) -> None:
        """Samples of states `x` and derivatives `dx` (m, 2r) in their units."""
        count = 2 * self.pairs
        x, dx = x / self.scaling.states(count), dx / self.scaling.rates(count)
        step = max(CHUNK // (count * int(self._columns[-1])), 1)
        for first in range(0, len(x), step):
            self._triangle.add(self._rows(x[first : first + step], dx[first : first + step]))

    def _rows(self, x: Array, dx: Array) -> Array:
        """Rows of the matrix and their target for scaled samples, divided by the channels' spread."""
        r, samples = self.pairs, len(x)
        q, p, rates, forces = x[:, :r], x[:, r:], dx[:, :r], dx[:, r:]
        # what a packed symmetric matrix S gives: S v, and ½ vᵀ S v
        units = symmetric(np.eye(self._entries), r)
        of_rates = np.einsum("eij,sj->sie", units, rates)
        springs = self._springs
        pulling = np.einsum("eij,sj->sie", units, q) if springs is None else gradients(springs, q)
        kinetic = 0.5 * np.einsum("eij,si,sj->se", units, rates, rates)
        monomials = evaluate_monomials(self.exponents, q)
        slopes = np.einsum(
            "sm,kmi->ski", evaluate_monomials(self._lowered, q), self._derivative, optimize=True
        )
        _, first, second, last = self._columns
        rows = np.zeros((samples, 2 * r, last + 1))
        mass = rows[..., :first].reshape(samples, 2 * r, self._entries, -1)
        mass[:, :r] = of_rates[..., None] * monomials[:, None, None, :]
        mass[:, r:] = kinetic[:, None, :, None] * slopes[:, :, None, :]
        rows[:, r:, first:second] = -pulling
        rows[:, r:, second:last] = -of_rates
        rows[:, :r, -1], rows[:, r:, -1] = p, forces
        rows /= self._spread[:, None]
        return rows.reshape(samples * 2 * r, -1)

    def solve(self, even: bool) -> PolynomialPortHamiltonian:
        """The fitted surrogate; `even`: with even powers alone, which is what a symmetric structure has."""
        kept = of_degrees(self.exponents, even)
        _, first, second, last = self._columns
        chosen = np.concatenate([np.tile(kept, self._entries), np.ones(last - first, dtype=np.bool_)])
        solution = self._triangle.solve(chosen)
        mass, pulls, dampers = np.split(
            solution, [len(solution) - last + first, len(solution) - last + second]
        )
        # what noise makes of a direction without damping may be slightly negative
        dampers = semidefinite_factor(symmetric(dampers, self.pairs))
        potential = None if self._springs is None else Potential(self._springs, pulls)
        springs = pulls if potential is None else np.zeros(self._entries)
        parameters = np.concatenate([mass, springs, dampers])
        return PolynomialPortHamiltonian(
            parameters, self.scaling, *self._states, self.exponents[kept], potential=potential
        )


class MassMatrices:
    """The least-squares problem for monomials up to `degree` where M is known at every configuration.

    An error δM changes q̇ = M⁻¹ p by −M⁻¹ δM q̇, and with it the dampers' forces by C M⁻¹ δM q̇. The one counts
    relative to the rates, the other to the springs' forces, which it nearly balances in slow motion; both on
    average over rates whose components are independent and as large as the samples'. A `potential` is fitted
    to the forces at rest.
    """

    def __init__(
        self, degree: int, scaling: PairScaling, samples: ConfigurationSamples, potential: bool = False
    ) -> None:
        self.scaling, self._samples = scaling, samples
        self.pairs = len(scaling.q)
        self._potential = potential_of(samples, scaling) if potential else None
        self.exponents = with_constant(self.pairs, degree)
        self._entries = packed_size(self.pairs)
        self._triangle = Triangle(self._entries * len(self.exponents))
        units = symmetric(np.eye(self._entries), self.pairs)
        rates = samples.dx_train[:, : self.pairs]
        springs = samples.forces if potential else samples.x_train[:, : self.pairs] @ samples.stiffness
        sizes, forces = (np.sqrt(np.mean(values**2, axis=0))[:, None] for values in (rates, springs))
        inverse = np.linalg.inv(samples.mass)
        errors = np.concatenate([inverse / sizes, samples.damping @ inverse / forces], axis=1)
        # (samples, rate in error, its cause, entry of δM); their triangle has the same sum of squares
        effects = np.einsum("sij,ejk,k->sike", errors, units, sizes[:, 0])
        weights = np.linalg.qr(effects.reshape(len(rates), -1, self._entries), mode="r")
        monomials = evaluate_monomials(self.exponents, samples.x_train[:, : self.pairs] / scaling.q)
        step = max(CHUNK // (self._entries**2 * len(self.exponents)), 1)
        for first in range(0, len(rates), step):
            part = slice(first, first + step)
            matrix = np.einsum("sde,sm->sdem", weights[part], monomials[part])
            target = np.einsum("sde,se->sd", weights[part], pack(samples.mass[part]))
            self._triangle.add(np.hstack([matrix.reshape(target.size, -1), target.reshape(-1, 1)]))

    def solve(self, even: bool) -> PolynomialPortHamiltonian:
        """The fitted surrogate; `even`: with even powers alone, which is what a symmetric structure has."""
        kept = of_degrees(self.exponents, even)
        coefficients = self._triangle.solve(np.tile(kept, self._entries)).reshape(self._entries, -1)
        return of_known_springs(
            coefficients, self.exponents[kept], self.scaling, self._samples, self._potential
        )


def potential_of(samples: ConfigurationSamples, scaling: PairScaling) -> Potential:
    """The polynomial potential whose force is nearest to that at rest, by least squares; each relative."""
    r, q = len(scaling.q), samples.x_train[:, : len(scaling.q)] / scaling.q
    exponents = _potential_monomials(r)
    forces = samples.forces * np.array(scaling.q) / scaling.energy
    sizes = np.sqrt(np.mean(forces**2, axis=0))
    triangle = Triangle(len(exponents))
    step = max(CHUNK // (r * len(exponents)), 1)
    for first in range(0, len(q), step):
        part = slice(first, first + step)
        rows = -gradients(exponents, q[part]) / sizes[:, None]
        target = forces[part] / sizes
        triangle.add(np.hstack([rows.reshape(target.size, -1), target.reshape(-1, 1)]))
    return Potential(exponents, triangle.solve())


def gradients(exponents: Exponents, q: Array) -> Array:
    """(m, r, count) of monomials (count, r) at q (m, r)."""
    lowered, tensor = differentiate(exponents)
    return np.asarray(np.einsum("sm,jmi->sji", evaluate_monomials(lowered, q), tensor, optimize=True))


def _potential_monomials(pairs: int) -> Exponents:
    """Those of the highest even degree up to `POTENTIAL_DEGREE` that are at most `POTENTIAL_MONOMIALS`."""
    degree = POTENTIAL_DEGREE
    while degree > 4 and math.comb(pairs + degree, degree) > POTENTIAL_MONOMIALS:
        degree -= 2
    return monomials_to_degree(pairs, degree)


def fit_port_hamiltonian(
    source: SampleSource, degree: int, potential: bool = False, sparse: bool = False
) -> PolynomialPortHamiltonian:
    """The polynomial port-Hamiltonian surrogate of total degree ≤ `degree` in M, from the training samples.

    `potential`: with a polynomial potential in the place of K. `sparse`, of configurations alone: with the
    monomials of `known_mass.fit_sparse`.

    By inverse dynamics, or from the mass matrices themselves where the samples have them; so many entries
    that they are too much for one problem each by itself. Odd powers are
    kept where they make validation better, by `as_good`. Samples are read twice,
    block by block. Raises NotPositiveDefinite if its mass matrix is none at a validation state, ValueError
    where the samples don't vary or are not finite.
    """
    scaling = pair_scaling(source.scales)
    problem: MassMatrices | SeparateEntries | InverseDynamics
    if sparse:
        assert isinstance(source, ConfigurationSamples)  # as configuration has seen to
        return _sparse(source, degree, potential_of(source, scaling) if potential else None)
    if isinstance(source, ConfigurationSamples):
        if packed_size(len(scaling.q)) * math.comb(len(scaling.q) + degree, degree) > LARGEST_TOGETHER:
            of_rest = potential_of(source, scaling) if potential else None
            problem = SeparateEntries(degree, scaling, source, of_rest)
        else:
            problem = MassMatrices(degree, scaling, source, potential)
    else:
        problem = InverseDynamics(degree, scaling, source, potential)
        for_each_piece(source.training_blocks(), problem.add)
    even, full = (_Candidate(problem.solve(kind)) for kind in (True, False))
    for_each_piece(source.validation_blocks(), even.add, full.add)
    if even.indefinite_at is not None and full.indefinite_at is not None:
        raise NotPositiveDefinite(even.surrogate, even.indefinite_at)
    return even.surrogate if as_good(even.loss(), full.loss()) else full.surrogate


def _sparse(
    samples: ConfigurationSamples, degree: int, potential: Potential | None
) -> PolynomialPortHamiltonian:
    candidate = _Candidate(fit_sparse(samples, degree, potential))
    for_each_piece(samples.validation_blocks(), candidate.add)
    if candidate.indefinite_at is not None:
        raise NotPositiveDefinite(candidate.surrogate, candidate.indefinite_at)
    return candidate.surrogate


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


def is_positive_definite(surrogate: PortHamiltonian, q: Array) -> NDArray[np.bool_]:
    """Whether the mass matrix is so at each of the coordinates q (m, r)."""
    smallest = np.linalg.eigvalsh(surrogate.mass_matrix(q))[:, 0]
    positive: NDArray[np.bool_] = smallest > 0.0
    return positive
