"""Linear least squares over any number of rows: QR of one block of rows after the other.

The triangle of all rows so far is what the next block is joined to (the sequential tall-skinny QR of
Demmel, Grigori, Hoemmen & Langou, SIAM J. Sci. Comput. 34, 2012): memory is bounded, and the condition
number is not squared as normal equations would.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq, qr

from flexsurr.simulation.rhs import Array


class Triangle:
    """The R factor of the rows [matrix, targets] seen so far; the matrix has `unknowns` columns."""

    def __init__(self, unknowns: int, targets: int = 1) -> None:
        self._unknowns = unknowns
        self._triangle = np.empty((0, unknowns + targets))

    def add(self, rows: Array) -> None:
        """Join `rows` (m, unknowns + targets), the targets last. LinAlgError where they are not finite."""
        (triangle,) = qr(np.concatenate([self._triangle, rows]), mode="r", overwrite_a=True)
        self._triangle = triangle[: triangle.shape[1]]

    def solve(self, chosen: NDArray[np.bool_] | None = None) -> Array:
        """The solution in the `chosen` unknowns (a mask; by default all), the others being zero and left out.

        A vector for one target, for several a column each. Rank-revealing: pivoted QR with normalised
        columns; what the rows leave undetermined is kept small.
        """
        matrix, targets = np.split(self._triangle, [self._unknowns], axis=1)
        if chosen is not None:
            matrix = matrix[:, chosen]
        norms = np.linalg.norm(matrix, axis=0)
        norms[norms == 0.0] = 1.0
        threshold = np.finfo(np.float64).eps * len(norms)
        solution, *_ = lstsq(matrix / norms, targets, cond=threshold, lapack_driver="gelsy")
        solution = solution / norms[:, None]
        found: Array = solution[:, 0] if solution.shape[1] == 1 else solution
        return found
