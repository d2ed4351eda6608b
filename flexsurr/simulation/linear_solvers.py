"""Small linear systems inside compiled code, where a call to LAPACK would cost more than the solution.

LU with partial pivoting, real or complex, for implicit integrators: its factors are used again, and pointers
to LAPACK's cannot be kept on disk. Cholesky and L D Lᵀ for mass matrices, by rows and packed: entry
(i, j ≤ i) at i (i + 1) / 2 + j.
"""

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT


@njit(error_model="numpy", fastmath=FLOATING_POINT, _nrt=False, cache=True)
def factorise(a, pivots):
    """Overwrite a (d, d) by its factors, the diagonal by its reciprocals; False if a is singular."""
    d = pivots.size
    for k in range(d):
        pivot = k
        largest = abs(a[k, k].real) + abs(a[k, k].imag)
        for i in range(k + 1, d):
            size = abs(a[i, k].real) + abs(a[i, k].imag)
            if size > largest:
                largest = size
                pivot = i
        if not largest > 0.0:  # zero or NaN
            return False
        pivots[k] = pivot
        if pivot != k:
            for j in range(d):
                a[k, j], a[pivot, j] = a[pivot, j], a[k, j]
        a[k, k] = 1.0 / a[k, k]
        for i in range(k + 1, d):
            factor = a[i, k] * a[k, k]
            a[i, k] = factor
            for j in range(k + 1, d):
                a[i, j] -= factor * a[k, j]
    return True


@njit(error_model="numpy", fastmath=FLOATING_POINT, _nrt=False, cache=True)
def solve(a, pivots, b):
    """Overwrite b (d,) by the solution of the system whose factors are `a` and `pivots`."""
    d = pivots.size
    for k in range(d):
        pivot = pivots[k]
        b[k], b[pivot] = b[pivot], b[k]
    for i in range(d):
        total = b[i]
        for j in range(i):
            total -= a[i, j] * b[j]
        b[i] = total
    for i in range(d - 1, -1, -1):
        total = b[i]
        for j in range(i + 1, d):
            total -= a[i, j] * b[j]
        b[i] = total * a[i, i]


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def solve_positive_definite(a, b, n):
    """Overwrite b[:n] with A⁻¹ b; A (n, n) by rows in a[:n*n], whose lower half is read and overwritten.

    Where A is not positive definite the result is not finite.
    """
    for i in range(n):
        row = a[i * n : i * n + i + 1]
        for j in range(i):
            other = a[j * n : j * n + j + 1]
            total = row[j]
            for k in range(j):
                total -= row[k] * other[k]
            row[j] = total * other[j]
        pivot = row[i]
        for k in range(i):
            pivot -= row[k] * row[k]
        row[i] = 1.0 / pivot**0.5  # the factor's diagonal is kept inverted: no division below
    for i in range(n):
        total = b[i]
        for k in range(i):
            total -= a[i * n + k] * b[k]
        b[i] = total * a[i * n + i]
    for i in range(n - 1, -1, -1):
        total = b[i]
        for k in range(i + 1, n):
            total -= a[k * n + i] * b[k]
        b[i] = total * a[i * n + i]


@njit(fastmath=FLOATING_POINT, error_model="numpy", _nrt=False, cache=True)
def solve_packed(work, matrix, b, r):
    """Overwrite b (r,) at its offset by the solution of the packed system at `matrix`, and that by L D Lᵀ.

    Not a number where the matrix is not positive definite.
    """
    for i in range(r):
        row = matrix + i * (i + 1) // 2
        pivot = work[row + i]
        total = work[b + i]
        for j in range(i):
            other = matrix + j * (j + 1) // 2
            factor = work[row + j]
            for k in range(j):
                factor -= work[row + k] * work[other + k]
            work[row + j] = factor
        for j in range(i):
            factor = work[row + j]
            scaled = factor * work[matrix + j * (j + 1) // 2 + j]
            pivot -= factor * scaled
            total -= scaled * work[b + j]
            work[row + j] = scaled
        work[row + i] = 1.0 / pivot if pivot > 0.0 else np.nan
        work[b + i] = total
    _solve_upper(work, matrix, b, r)


@njit(fastmath=FLOATING_POINT, error_model="numpy", _nrt=False, cache=True)
def _solve_upper(work, matrix, b, r):
    """Overwrite b by the solution of D Lᵀ x = b, for what `solve_packed` leaves at `matrix`."""
    for i in range(r - 1, -1, -1):
        total = work[b + i] * work[matrix + i * (i + 1) // 2 + i]
        for j in range(i + 1, r):
            total -= work[matrix + j * (j + 1) // 2 + i] * work[b + j]
        work[b + i] = total


@njit(fastmath=FLOATING_POINT, error_model="numpy", _nrt=False, cache=True)
def invert_packed(work, matrix, inverse, r):
    """Write the inverse (r, r) of the packed matrix at its offset, and overwrite that by L D Lᵀ."""
    for i in range(r):
        work[inverse + i] = 1.0 if i == 0 else 0.0
    solve_packed(work, matrix, inverse, r)
    for k in range(1, r):
        column = inverse + k * r
        for i in range(r):
            total = 1.0 if i == k else 0.0
            for j in range(i):
                total -= work[matrix + i * (i + 1) // 2 + j] * work[column + j]
            work[column + i] = total
        _solve_upper(work, matrix, column, r)
