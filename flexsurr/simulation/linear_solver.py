"""LU factorisation with partial pivoting, real or complex, for the small systems of implicit integrators.

Inlined into them it costs a fraction of a call to LAPACK, whose use would need the factors again in each
call or pointers that cannot be kept on disk.
"""

from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT


@njit(error_model="numpy", fastmath=FLOATING_POINT, _nrt=False)
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


@njit(error_model="numpy", fastmath=FLOATING_POINT, _nrt=False)
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
