"""Fully connected layers: where their weights lie in one vector, and compiled code for them, forth and back.

In compiled code everything passed between layers lies in one workspace; layers are offsets into it and into
the weights. Offsets and counters are unsigned: numba lets a signed index be negative, and a loop in which
it cannot rule that out does not vectorise. One array instead of a tuple or slices, because taking a
reference to an array costs as much as a layer.
"""

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT, Array

Shapes = list[tuple[int, ...]]


def layer_shapes(widths: Sequence[int]) -> Shapes:
    """Weights (from, to) and biases (to,) of each layer between these `widths`, the inputs' first.

    Inputs come first so that a loop over neurons runs through neighbouring numbers.
    """
    return [shape for n, m in itertools.pairwise(widths) for shape in ((n, m), (m,))]


def size_of(shapes: Shapes) -> int:
    """How many numbers arrays of these shapes hold."""
    return sum(map(math.prod, shapes))


def views(parameters: Array, shapes: Shapes) -> list[Array]:
    """Views of the vector `parameters`, which holds arrays of these shapes one after the other."""
    pieces = np.split(parameters, np.cumsum([math.prod(shape) for shape in shapes[:-1]]))
    return [piece.reshape(shape) for piece, shape in zip(pieces, shapes, strict=True)]


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def forward(parameters, layer, n, m, work, inputs, z):
    """z_k = b_k + Σ_j a_j W_jk for the layer of n inputs and m neurons at the offset `layer`."""
    biases = layer + n * m
    for k in range(m):
        work[z + k] = parameters[biases + k]
    for j in range(n):
        a = work[inputs + j]
        row = layer + j * m
        for k in range(m):
            work[z + k] += a * parameters[row + k]


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def back(parameters, layer, n, m, work, z, inputs):
    """a_j = Σ_k W_jk z_k, the transpose of `forward` without biases."""
    for j in range(n):
        total = 0.0
        row = layer + j * m
        for k in range(m):
            total += parameters[row + k] * work[z + k]
        work[inputs + j] = total


@njit(error_model="numpy")
def offset(number):
    """`number` as an offset."""
    return np.uint64(number)
