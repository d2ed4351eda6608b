"""Sets of monomials in several variables, as rows of exponents."""

import itertools

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.simulation.rhs import FLOATING_POINT, Array
from flexsurr.surrogates.layers import offset

Exponents = NDArray[np.int64]


def monomials_to_degree(variables: int, degree: int) -> Exponents:
    """All monomials of total degree 1 … `degree`, by degree: (count, variables). No constant."""
    rows = [
        np.bincount(np.array(chosen), minlength=variables)
        for total in range(1, degree + 1)
        for chosen in itertools.combinations_with_replacement(range(variables), total)
    ]
    return np.array(rows, dtype=np.int64)


def evaluate_monomials(exponents: Exponents, x: Array) -> Array:
    """The monomials (count, d) at `x` (..., d), shape (..., count)."""
    powers = x[..., None] ** np.arange(int(exponents.max(initial=0)) + 1)
    result = powers[..., 0, exponents[:, 0]]
    for variable in range(1, exponents.shape[1]):
        result = result * powers[..., variable, exponents[:, variable]]
    return result


def differentiate(exponents: Exponents) -> tuple[Exponents, Array]:
    """Monomials (m, d) and a tensor (d, m, count) with ∂(monomial i)/∂x_j = Σ_k tensor[j, k, i] lower_k.

    The lower monomials are ordered by degree and closed: each but the constant, which comes first,
    is another one of them times a variable.
    """
    count, d = exponents.shape
    lowered = exponents[:, None, :] - np.eye(d, dtype=np.int64)
    present = {tuple(row) for row in lowered.reshape(-1, d).tolist() if min(row) >= 0}
    present.add((0,) * d)
    pending = list(present)
    while pending:
        parent = _divided(pending.pop())
        if parent not in present:
            present.add(parent)
            pending.append(parent)
    ordered = sorted(present, key=lambda row: (sum(row), row))
    place = {row: k for k, row in enumerate(ordered)}
    tensor = np.zeros((d, len(ordered), count))
    for i, j in np.argwhere(exponents > 0):
        tensor[j, place[tuple(lowered[i, j].tolist())], i] = exponents[i, j]
    return np.array(ordered, dtype=np.int64), tensor


def products(exponents: Exponents) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Of a closed set, after its constant: monomial k + 1 is monomial parents[k] times x[variables[k]]."""
    place = {tuple(row): k for k, row in enumerate(exponents.tolist())}
    rows = [tuple(row) for row in exponents[1:].tolist()]
    parents = np.array([place[_divided(row)] for row in rows], dtype=np.int64)
    return parents, np.array([_last_variable(row) for row in rows], dtype=np.int64)


def factors(exponents: Exponents) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Of a set that begins with the constant: monomial k + 1 is monomial parents[k] times factor [k].

    Factors 0 … d − 1 are the variables; those after them are the products of variables i ≥ j, number
    d + i (i + 1) / 2 + j. A set of even degrees needs only products, and is built without the odd ones.
    Raises ValueError for a set that does not begin with the constant or cannot be built so.
    """
    rows = [tuple(row) for row in exponents.tolist()]
    if not rows or any(rows[0]):
        raise ValueError("the first monomial must be the constant")
    d = exponents.shape[1]
    place = {row: k for k, row in enumerate(rows)}
    parents, of_factors = [], []
    for k, row in enumerate(rows[1:], start=1):
        i = _last_variable(row)
        once = _divided(row)
        j = _last_variable(once)
        if sum(row) > 1 and place.get(_divided(once), k) < k:
            parents.append(place[_divided(once)])
            of_factors.append(d + i * (i + 1) // 2 + j)
        elif place.get(once, k) < k:
            parents.append(place[once])
            of_factors.append(i)
        else:
            raise ValueError(f"monomial {row} is no product of an earlier one and one or two variables")
    return np.array(parents, dtype=np.int64), np.array(of_factors, dtype=np.int64)


def closed(exponents: Exponents) -> Exponents:
    """The set with the constant, and what more `factors` needs to build it, by degree."""
    present = {tuple(row) for row in exponents.tolist()} | {(0,) * exponents.shape[1]}
    pending = list(present)
    while pending:
        row = pending.pop()
        once = _divided(row)
        if {once, _divided(once)}.isdisjoint(present):
            present.add(_divided(once))
            pending.append(_divided(once))
    return np.array(sorted(present, key=lambda row: (sum(row), row)), dtype=np.int64)


def runs(exponents: Exponents) -> tuple[NDArray[np.intp], NDArray[np.uint64]]:
    """How to build a set, as `factors` does, in few pieces: an order (count,) of it, and the pieces (n, 4).

    A row (factor, parent, first, length) says that in this order `length` monomials from `first` on are those
    from `parent` on, times the factor. Sorted by degree, then by their last variables, all monomials to some
    degree come in one run for each factor and degree: those that a factor makes are a whole stretch of an
    earlier degree. No piece holds what it is built from: `pull_back` may take its monomials in any order.
    """
    order = np.lexsort((*exponents.T, exponents.sum(axis=1)))
    pieces: list[list[int]] = []
    for place, (parent, factor) in enumerate(zip(*factors(exponents[order]), strict=True), start=1):
        if pieces and pieces[-1][:2] == [factor, parent - pieces[-1][3]] and parent < pieces[-1][2]:
            pieces[-1][3] += 1
        else:
            pieces.append([int(factor), int(parent), place, 1])
    return order, np.array(pieces, dtype=np.uint64).reshape(-1, 4)


@njit(fastmath=FLOATING_POINT, error_model="numpy", _nrt=False, cache=True)
def write_monomials(pieces, d, phi, work):
    """The monomials of the d variables at `work`'s start, from `phi` on, built in the pieces of `runs`.

    Products of two variables are left after the variables.
    """
    place = d
    for i in range(d):
        for j in range(i + offset(1)):
            work[place] = work[i] * work[j]
            place += offset(1)
    work[phi] = 1.0
    for n in range(len(pieces)):
        factor = work[pieces[n, 0]]
        parent = phi + pieces[n, 1]
        first = phi + pieces[n, 2]
        for k in range(pieces[n, 3]):
            work[first + k] = work[parent + k] * factor


@njit(fastmath=FLOATING_POINT, error_model="numpy", _nrt=False, cache=True)
def pull_back(pieces, d, phi, adjoint, slopes, work):
    """From derivatives by each monomial, at `adjoint`, those by each of the d variables, left at `slopes`.

    `write_monomials` must have run; derivatives by products of two variables take the places after those.
    """
    for k in range(d + d * (d + offset(1)) // offset(2)):
        work[slopes + k] = 0.0
    for back in range(len(pieces)):
        n = len(pieces) - 1 - back
        factor = work[pieces[n, 0]]
        parent = pieces[n, 1]
        first = pieces[n, 2]
        total = 0.0
        for k in range(pieces[n, 3]):
            a = work[adjoint + first + k]
            total += a * work[phi + parent + k]
            work[adjoint + parent + k] += a * factor
        work[slopes + pieces[n, 0]] += total
    place = slopes + d
    for i in range(d):
        for j in range(i + offset(1)):
            work[slopes + i] += work[place] * work[j]
            work[slopes + j] += work[place] * work[i]
            place += offset(1)


@njit(fastmath=FLOATING_POINT, error_model="numpy", _nrt=False, cache=True)
def pull_back_along(pieces, d, phi, adjoint, slopes, variable, tangents, work):
    """∂/∂x_variable of what `pull_back` has left at `slopes`, left at the start of `tangents`.

    `pull_back` must have run. Scratch from `tangents` on: slopes and factors (d and the products of two
    variables, each), monomials, adjoints.
    """
    size = d + d * (d + offset(1)) // offset(2)
    by_factor = tangents + size
    by_phi = by_factor + size
    count = adjoint - phi
    by_adjoint = by_phi + count
    for k in range(d):
        work[by_factor + k] = 1.0 if k == variable else 0.0
    place = by_factor + d
    for i in range(d):
        for j in range(i + offset(1)):
            work[place] = work[by_factor + i] * work[j] + work[i] * work[by_factor + j]
            place += offset(1)
    work[by_phi] = 0.0
    for n in range(len(pieces)):
        factor = work[pieces[n, 0]]
        its_tangent = work[by_factor + pieces[n, 0]]
        parent = pieces[n, 1]
        first = by_phi + pieces[n, 2]
        for k in range(pieces[n, 3]):
            work[first + k] = work[by_phi + parent + k] * factor + work[phi + parent + k] * its_tangent
    for k in range(size):
        work[tangents + k] = 0.0
    for k in range(count):
        work[by_adjoint + k] = 0.0
    for back in range(len(pieces)):
        n = len(pieces) - 1 - back
        factor = work[pieces[n, 0]]
        its_tangent = work[by_factor + pieces[n, 0]]
        parent = pieces[n, 1]
        first = pieces[n, 2]
        total = 0.0
        for k in range(pieces[n, 3]):
            a = work[adjoint + first + k]
            b = work[by_adjoint + first + k]
            total += b * work[phi + parent + k] + a * work[by_phi + parent + k]
            work[by_adjoint + parent + k] += b * factor + a * its_tangent
        work[tangents + pieces[n, 0]] += total
    place = d
    for i in range(d):
        for j in range(i + offset(1)):
            a = work[slopes + place]
            b = work[tangents + place]
            work[tangents + i] += b * work[j] + a * work[by_factor + j]
            work[tangents + j] += b * work[i] + a * work[by_factor + i]
            place += offset(1)


@njit(fastmath=FLOATING_POINT, error_model="numpy", _nrt=False, cache=True)
def write_hessian(pieces, d, phi, adjoint, slopes, inverse, hessian, tangents, work):
    """Second derivatives (d, d) at `hessian`, row by row, of what `pull_back` has left the first ones of.

    By what becomes a variable when it is taken times its `inverse` (d,). Scratch as of `pull_back_along`.
    """
    for m in range(d):
        pull_back_along(pieces, d, phi, adjoint, slopes, m, tangents, work)
        for k in range(d):
            work[hessian + k * d + m] = work[tangents + k] * inverse[k] * inverse[m]


def _last_variable(row: tuple[int, ...]) -> int:
    return max((j for j, power in enumerate(row) if power), default=0)


def _divided(row: tuple[int, ...]) -> tuple[int, ...]:
    """The monomial over its last variable; the constant is its own."""
    j = _last_variable(row)
    return (*row[:j], max(row[j] - 1, 0), *row[j + 1 :])
