"""Small symmetric and lower triangular matrices, packed: entry (i, j ≤ i) at i (i + 1) / 2 + j."""

import numpy as np
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
