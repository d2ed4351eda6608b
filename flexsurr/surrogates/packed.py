"""Small symmetric and lower triangular matrices, packed: entry (i, j ≤ i) at i (i + 1) / 2 + j.

The compiled part works in place on one workspace, for systems too small for a library's overhead.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.simulation.rhs import FLOATING_POINT, Array

OPTIONS = {"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False}


def packed_size(r: int) -> int:
    """Number of entries of a packed (r, r) matrix."""
    return r * (r + 1) // 2


def rows_and_columns(r: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Row and column of each packed entry."""
    return np.tril_indices(r)


def pack(matrix: Array) -> Array:
    """The lower triangle of (..., r, r) matrices, shape (..., r (r + 1) / 2)."""
    rows, columns = rows_and_columns(matrix.shape[-1])
    packed: Array = matrix[..., rows, columns]
    return packed


def lower(packed: Array, r: int) -> Array:
    """Lower triangular matrices (..., r, r) of packed ones."""
    rows, columns = rows_and_columns(r)
    matrix = np.zeros((*packed.shape[:-1], r, r))
    matrix[..., rows, columns] = packed
    return matrix


def symmetric(packed: Array, r: int) -> Array:
    """Symmetric matrices (..., r, r) of packed ones."""
    rows, columns = rows_and_columns(r)
    matrix = lower(packed, r)
    matrix[..., columns, rows] = packed
    return matrix


def semidefinite_factor(matrix: Array) -> Array:
    """Packed L with L Lᵀ the positive semidefinite matrix nearest to the symmetric `matrix` (r, r)."""
    values, vectors = np.linalg.eigh(matrix)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    _, triangle = np.linalg.qr(root.T)
    return pack(triangle.T * np.where(np.diag(triangle) < 0.0, -1.0, 1.0))


@njit(**OPTIONS)
def solve_positive_definite(work, matrix, b, r):
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
    for i in range(r - 1, -1, -1):
        total = work[b + i] * work[matrix + i * (i + 1) // 2 + i]
        for j in range(i + 1, r):
            total -= work[matrix + j * (j + 1) // 2 + i] * work[b + j]
        work[b + i] = total
