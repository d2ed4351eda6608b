"""JᵀJ and Jᵀr of least-squares problems, accumulated so that memory does not grow with the samples."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from flexsurr.simulation.rhs import Array

Rows = Callable[[slice, Array, Array], None]
"""Fills residuals and Jacobian of a slice of the samples; both may be longer than the slice asks for."""


class NormalEquations(NamedTuple):
    """JᵀJ (n, n) and Jᵀr (n,) of residuals r whose sum of squares is the loss."""

    loss: float
    gram: Array
    gradient: Array


def accumulated(rows: Rows, shape: tuple[int, ...], unknowns: int, chunk: int) -> NormalEquations:
    """Of `shape` = (m, d) residuals, d for each sample; at most `chunk` elements of the Jacobian at a time.

    Of the Jacobian there is at least one sample's part.
    """
    samples, d = shape
    step = min(max(chunk // (unknowns * d), 1), samples)
    jacobian, residuals = np.empty((step * d, unknowns)), np.empty(step * d)
    loss, gram, gradient = 0.0, np.zeros((unknowns, unknowns)), np.zeros(unknowns)
    for first in range(0, samples, step):
        part = slice(first, first + step)
        rows(part, residuals, jacobian)
        filled = d * (min(first + step, samples) - first)
        loss += float(residuals[:filled] @ residuals[:filled])
        gram += jacobian[:filled].T @ jacobian[:filled]
        gradient += jacobian[:filled].T @ residuals[:filled]
    return NormalEquations(loss, gram, gradient)
