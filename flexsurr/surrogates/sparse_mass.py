"""Compiled equations of a polynomial mass matrix most of whose coefficients are zero.

Entries of M with the same monomials are a group: these are fetched once, side by side, and every entry of the
group is a dense product with them. Mirror symmetry makes few groups of many entries.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.simulation.jacobian import implements_jacobian
from flexsurr.simulation.linear_solvers import invert_packed, solve_packed
from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.surrogates.layers import offset
from flexsurr.surrogates.monomials import pull_back, write_hessian, write_monomials
from flexsurr.surrogates.packed import OPTIONS
from flexsurr.surrogates.port_hamiltonian import (
    jacobian_of_motion,
    springs_and_dampers,
    write_kinetic_adjoint,
)

LOOKED_UP = 2
"""What a coefficient with its place costs, over one in a dense product."""

GROUPED = 750
"""How many coefficients of a dense product the loops over groups cost: what a call does for any of them."""


def looking_up_pays(coefficients: Array) -> bool:
    """Whether the `coefficients` (entry, monomial) are cheaper by those that are not zero than all of them.

    The constants are of wall times with two to ten modes. The dense product has loops of one length, which a
    processor foresees, and fills its vectors; groups of few monomials do neither.
    """
    return bool(LOOKED_UP * np.count_nonzero(coefficients) + GROUPED < coefficients.size)


class SparseMassKernel(NamedTuple):
    """Monomials of q times `inverse_q` (r,), as `write_monomials` makes them of `pieces`.

    A row of `groups` is a group's number of monomials and of entries. `places` has the monomials of one group
    after the other, `entries` which packed entries of M are of it, `mass` their coefficients, entry by entry.
    `stiffness` and `damping` are (r, r) row by row.
    """

    inverse_q: Array
    pieces: NDArray[np.uint64]
    groups: NDArray[np.uint64]
    places: NDArray[np.uint64]
    entries: NDArray[np.uint64]
    mass: Array
    stiffness: Array
    damping: Array
    monomials: int


def sparse_kernel(
    inverse_q: Array, pieces: NDArray[np.uint64], coefficients: Array, stiffness: Array, damping: Array
) -> tuple[NamedTuple, int]:
    """The kernel of `coefficients` (entry, monomial), and the size of its workspace."""
    entries, count = coefficients.shape
    by_pattern: dict[bytes, list[int]] = {}
    for e, present in enumerate(coefficients != 0.0):
        by_pattern.setdefault(present.tobytes(), []).append(e)
    groups, places, order, mass = [], [], [], []
    for pattern, members in by_pattern.items():
        present = np.flatnonzero(np.frombuffer(pattern, dtype=np.bool_))
        groups.append((len(present), len(members)))
        places.append(present)
        order += members
        mass.append(coefficients[members][:, present].ravel())
    kernel = SparseMassKernel(
        inverse_q,
        pieces,
        np.array(groups, dtype=np.uint64),
        np.concatenate(places).astype(np.uint64),
        np.array(order, dtype=np.uint64),
        np.concatenate(mass),
        np.ascontiguousarray(stiffness).ravel(),
        np.ascontiguousarray(damping).ravel(),
        count,
    )
    r = len(inverse_q)
    size = r + entries
    # of the right-hand side 2 size + 3 count + entries + r; its Jacobian needs more
    return kernel, 4 * size + 5 * count + entries + 3 * r * r


@njit(forceinline=True, **OPTIONS)
def _write_mass(kernel, phi, fetched, matrix, work):
    """The packed M at `matrix` of the monomials at `phi`."""
    groups, places, order, mass = kernel.groups, kernel.places, kernel.entries, kernel.mass
    place = offset(0)
    e = offset(0)
    row = offset(0)
    for g in range(len(groups)):
        some = groups[g, 0]
        for k in range(some):
            work[fetched + k] = work[phi + places[place + k]]
        for _ in range(groups[g, 1]):
            total = 0.0
            for k in range(some):
                total += mass[row + k] * work[fetched + k]
            work[matrix + order[e]] = total
            row += some
            e += offset(1)
        place += some


@njit(forceinline=True, **OPTIONS)
def _write_adjoint(kernel, weights, fetched, adjoint, count, work):
    """Derivatives by the monomials, at `adjoint`, of the entries of M times their weights, at `weights`."""
    groups, places, order, mass = kernel.groups, kernel.places, kernel.entries, kernel.mass
    for k in range(count):
        work[adjoint + k] = 0.0
    place = offset(0)
    e = offset(0)
    row = offset(0)
    for g in range(len(groups)):
        some = groups[g, 0]
        for k in range(some):
            work[fetched + k] = 0.0
        for _ in range(groups[g, 1]):
            weight = work[weights + order[e]]
            for k in range(some):
                work[fetched + k] += weight * mass[row + k]
            row += some
            e += offset(1)
        for k in range(some):
            work[adjoint + places[place + k]] += work[fetched + k]
        place += some


@implements_rhs(SparseMassKernel, inline=False)
def _sparse_mass(kernel, t, x, dx, work):
    inverse_q, pieces, stiffness, damping = kernel.inverse_q, kernel.pieces, kernel.stiffness, kernel.damping
    r = offset(inverse_q.size)
    entries = offset(kernel.entries.size)
    count = offset(kernel.monomials)
    # work: factors and their adjoints, monomials and theirs, those of a group, the packed M, the rates
    slopes = r + entries
    phi = slopes + r + entries
    adjoint = phi + count
    fetched = adjoint + count
    matrix = fetched + count
    rates = matrix + entries
    for i in range(r):
        work[i] = x[i] * inverse_q[i]
    write_monomials(pieces, r, phi, work)
    _write_mass(kernel, phi, fetched, matrix, work)
    for i in range(r):
        work[rates + i] = x[r + i]
    solve_packed(work, np.int64(matrix), np.int64(rates), np.int64(r))
    for i in range(r):
        dx[i] = work[rates + i]
    # the adjoint of ½ q̇ᵀ M q̇: by the entries of M, in their places; by the monomials; by q
    write_kinetic_adjoint(dx, r, work, matrix)
    _write_adjoint(kernel, matrix, fetched, adjoint, count, work)
    pull_back(pieces, r, phi, adjoint, slopes, work)
    for i in range(r):
        dx[r + i] = work[slopes + i] * inverse_q[i]
    springs_and_dampers(stiffness, damping, x, dx)


@implements_jacobian(SparseMassKernel)
def _jacobian_of_sparse_mass(kernel, t, x, dx, jac, work):
    inverse_q, pieces = kernel.inverse_q, kernel.pieces
    r = offset(inverse_q.size)
    entries = offset(kernel.entries.size)
    count = offset(kernel.monomials)
    # work: as of the right-hand side, then M⁻¹, (∂M/∂q_k) q̇ column by column, curvature, tangents
    slopes = r + entries
    phi = slopes + r + entries
    adjoint = phi + count
    fetched = adjoint + count
    matrix = fetched + count
    inverse = matrix + entries
    turned = inverse + r * r
    curvature = turned + r * r
    tangents = curvature + r * r
    for i in range(r):
        work[i] = x[i] * inverse_q[i]
    write_monomials(pieces, r, phi, work)
    _write_mass(kernel, phi, fetched, matrix, work)
    invert_packed(work, np.int64(matrix), np.int64(inverse), np.int64(r))
    # row i of M q̇, with q̇ held, is a polynomial
    for i in range(r):
        for e in range(entries):
            work[matrix + e] = 0.0
        for j in range(r):
            low = min(i, j)
            high = max(i, j)
            work[matrix + high * (high + offset(1)) // offset(2) + low] = dx[j]
        _write_adjoint(kernel, matrix, fetched, adjoint, count, work)
        pull_back(pieces, r, phi, adjoint, slopes, work)
        for k in range(r):
            work[turned + i * r + k] = work[slopes + k] * inverse_q[k]
    # and so is ½ q̇ᵀ M q̇
    write_kinetic_adjoint(dx, r, work, matrix)
    _write_adjoint(kernel, matrix, fetched, adjoint, count, work)
    pull_back(pieces, r, phi, adjoint, slopes, work)
    write_hessian(pieces, r, phi, adjoint, slopes, inverse_q, curvature, tangents, work)
    jacobian_of_motion(kernel.stiffness, kernel.damping, work, inverse, turned, curvature, jac)
    return 0
