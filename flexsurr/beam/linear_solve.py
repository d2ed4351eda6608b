"""Cholesky's factorisation inside a kernel's workspace."""

from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT


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
