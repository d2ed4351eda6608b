"""Fully connected layers in compiled code, forwards and back.

The weights of all layers lie in one vector, as `Network` has them, and everything passed between
layers lies in one workspace; layers are offsets into both. Offsets and counters are unsigned: numba
lets a signed index be negative, and a loop in which it cannot rule that out does not vectorise. One
array instead of a tuple or slices, because taking a reference to an array costs as much as a layer.
"""

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT


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
