"""Polynomials for a mass matrix that is known at sampled configurations, every entry by itself.

Entries that share their monomials share one factor of the least-squares problem, so that thousands of
unknowns take seconds. Where structures are their own mirror images most monomials have no place in most
entries; and of the others many count for nothing, as those of high modes, which move little.
"""

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import PairScaling, PolynomialPortHamiltonian, pair_scaling
from flexsurr.surrogates.monomials import Exponents, closed, evaluate_monomials, monomials_to_degree
from flexsurr.surrogates.packed import pack, packed_size, rows_and_columns, semidefinite_factor
from flexsurr.surrogates.potential import Potential
from flexsurr.training.configuration_samples import ConfigurationSamples
from flexsurr.training.least_squares import Triangle
from flexsurr.training.losses import AS_GOOD

CHUNK = 1 << 22  # elements of the matrix that exist at a time: 32 MB
HELD_OUT = 0.2  # of the samples, by which monomials are chosen
CLOSE = 0.03  # of the number of monomials: how near to the fewest the search ends


class SeparateEntries:
    """The least-squares problem for monomials up to `degree` in every entry of M, all samples alike."""

    def __init__(
        self, degree: int, scaling: PairScaling, samples: ConfigurationSamples, potential: Potential | None
    ) -> None:
        self.scaling, self._samples, self._potential = scaling, samples, potential
        self.exponents = with_constant(len(scaling.q), degree)
        q, entries = _scaled(samples, scaling)
        self._triangle = _triangle(self.exponents, q, entries)

    def solve(self, even: bool) -> PolynomialPortHamiltonian:
        """The fitted surrogate; `even`: with even powers alone, which is what a symmetric structure has."""
        kept = of_degrees(self.exponents, even)
        found = self._triangle.solve(kept).reshape(np.count_nonzero(kept), -1)
        coefficients = found.T * _sizes(self._samples)[:, None]
        return of_known_springs(
            coefficients, self.exponents[kept], self.scaling, self._samples, self._potential
        )


def fit_sparse(
    samples: ConfigurationSamples, degree: int, potential: Potential | None = None
) -> PolynomialPortHamiltonian:
    """The surrogate with the fewest monomials up to `degree` in each entry that are about as accurate as all.

    Entries of one parity under the samples' mirrors have the monomials of that parity. Of these, in the order
    of what they contribute, so many are kept that held-out samples err at most `AS_GOOD` times as much, in
    the mean square, as with all, or as M does on average.
    """
    scaling = pair_scaling(samples.scales)
    exponents = with_constant(len(scaling.q), degree)
    q, entries = _scaled(samples, scaling)
    classes = [
        _Class(exponents, monomials, q, entries, members)
        for monomials, members in parities(exponents, samples.mirrors)
    ]
    overall = sum(each.error() * len(each.members) for each in classes) / packed_size(len(scaling.q))
    coefficients = np.zeros((packed_size(len(scaling.q)), len(exponents)))
    for each in classes:
        kept, found = each.fewest(AS_GOOD * max(each.error(), overall))
        coefficients[np.ix_(each.members, kept)] = found.T
    used = np.flatnonzero(np.any(coefficients != 0.0, axis=0))
    kept_exponents = closed(exponents[used])
    place = {tuple(row): k for k, row in enumerate(kept_exponents.tolist())}
    placed = np.zeros((len(coefficients), len(kept_exponents)))
    placed[:, [place[tuple(row)] for row in exponents[used].tolist()]] = coefficients[:, used]
    placed *= _sizes(samples)[:, None]
    return of_known_springs(placed, kept_exponents, scaling, samples, potential)


def parities(exponents: Exponents, mirrors: Array) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """For each parity that entries of M have: the monomials of that parity, and the packed entries.

    `mirrors` (k, r) are signs of the coordinates. Without any all monomials belong to all entries.
    """
    flips = (mirrors < 0.0).astype(np.int64)
    rows, columns = rows_and_columns(exponents.shape[1])
    of_monomials = (exponents @ flips.T) % 2
    of_entries = (flips[:, rows] + flips[:, columns]).T % 2
    return [
        (
            np.flatnonzero(np.all(of_monomials == parity, axis=1)),
            np.flatnonzero(np.all(of_entries == parity, axis=1)),
        )
        for parity in np.unique(of_entries, axis=0)
    ]


class _Class:
    """The entries of one parity, and the least-squares problem of their monomials."""

    def __init__(
        self,
        exponents: Exponents,
        monomials: NDArray[np.intp],
        q: Array,
        entries: Array,
        members: NDArray[np.intp],
    ) -> None:
        self.members = members
        self._monomials = monomials
        cut = len(q) - round(HELD_OUT * len(q))
        self._triangle = _triangle(exponents[monomials], q[:cut], entries[:cut, members])
        self._held_out = evaluate_monomials(exponents[monomials], q[cut:])
        self._target = entries[cut:, members]
        self._all = np.ones(len(monomials), dtype=np.bool_)

    def _solution(self, chosen: NDArray[np.bool_]) -> Array:
        return self._triangle.solve(chosen).reshape(-1, len(self.members))

    def error(self, chosen: NDArray[np.bool_] | None = None) -> float:
        """The mean square over held-out samples and entries; by default with all monomials."""
        chosen = self._all if chosen is None else chosen
        errors = self._held_out[:, chosen] @ self._solution(chosen) - self._target
        return float(np.mean(errors**2))

    def fewest(self, allowed: float) -> tuple[NDArray[np.intp], Array]:
        """About the fewest monomials that err at most `allowed`, and their coefficients (monomial, entry)."""
        size = np.sqrt(np.mean(self._held_out**2, axis=0))
        contributions = np.max(np.abs(self._solution(self._all)), axis=1) * size
        order = np.argsort(-contributions)

        def first(count: int) -> NDArray[np.bool_]:
            chosen = np.zeros(len(order), dtype=np.bool_)
            chosen[order[:count]] = True
            return chosen

        too_few, enough = 0, len(order)
        while enough - too_few > max(CLOSE * enough, 1):
            middle = (too_few + enough) // 2
            if self.error(first(middle)) <= allowed:
                enough = middle
            else:
                too_few = middle
        chosen = first(enough)
        return self._monomials[chosen], self._solution(chosen)


def with_constant(pairs: int, degree: int) -> Exponents:
    """Monomials of total degree ≤ `degree`, the constant first."""
    constant = np.zeros((1, pairs), dtype=np.int64)
    return np.concatenate([constant, monomials_to_degree(pairs, degree)])


def of_degrees(exponents: Exponents, even: bool) -> NDArray[np.bool_]:
    """A mask of all of them, or of those of even degree."""
    return np.asarray(exponents.sum(axis=1) % (2 if even else 1) == 0)


def of_known_springs(
    coefficients: Array,
    exponents: Exponents,
    scaling: PairScaling,
    samples: ConfigurationSamples,
    potential: Potential | None,
) -> PolynomialPortHamiltonian:
    """The surrogate of M's `coefficients` (entry, monomial) of scaled q, with known springs and dampers."""
    q, energy, action = np.array(scaling.q), scaling.energy, scaling.action
    of_products = np.outer(q, q)
    parameters = [
        coefficients * (pack(of_products) * energy / action**2)[:, None],
        pack(samples.stiffness * of_products / energy) * (potential is None),
        semidefinite_factor(samples.damping * of_products / action),
    ]
    return PolynomialPortHamiltonian(
        np.concatenate([part.ravel() for part in parameters]),
        scaling,
        samples.state_names,
        samples.state_units,
        exponents,
        potential=potential,
    )


def _sizes(samples: ConfigurationSamples) -> Array:
    """(entries,) what errors of M's entries are relative to: the sizes of its diagonal."""
    sizes = np.sqrt(np.mean(np.diagonal(samples.mass, axis1=1, axis2=2) ** 2, axis=0))
    return pack(np.sqrt(np.outer(sizes, sizes)))


def _scaled(samples: ConfigurationSamples, scaling: PairScaling) -> tuple[Array, Array]:
    """Scaled q (m, r), and the entries of M (m, entries) relative to their sizes."""
    return samples.x_train[:, : len(scaling.q)] / scaling.q, pack(samples.mass) / _sizes(samples)


def _triangle(exponents: Exponents, q: Array, entries: Array) -> Triangle:
    """That of monomials at q (m, r), with the entries (m, k) as targets."""
    triangle = Triangle(len(exponents), entries.shape[1])
    step = max(CHUNK // (len(exponents) + entries.shape[1]), 1)
    for first in range(0, len(q), step):
        part = slice(first, first + step)
        triangle.add(np.hstack([evaluate_monomials(exponents, q[part]), entries[part]]))
    return triangle
