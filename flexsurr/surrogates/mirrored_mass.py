"""Neurons that come with their mirror images: a mass matrix with exactly the symmetries of its structure.

S_g are the changes of sign that k planes of symmetry and their combinations make, g from 0 to 2ᵏ − 1. An
entry of M that changes its sign by χ(g) is

    M_e(q) = F_e + Λ_e + Σ_k R_ek Σ_g χ_e(g) σ(w_k · S_g q + b_k)

Bits of g say which planes take part, bits of a parity c which of them turn its sign: χ_c(g) is −1 where g & c
has an odd number of bits, else 1. Sums over g of such signs are Walsh–Hadamard transforms. Since R is read
once for all images, a neuron with its images costs little more than one alone.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.simulation.linear_solvers import solve_packed
from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.surrogates.activations import slope, value
from flexsurr.surrogates.layers import offset
from flexsurr.surrogates.packed import OPTIONS, rows_and_columns
from flexsurr.surrogates.port_hamiltonian import springs_and_dampers, write_kinetic_adjoint


class Images(NamedTuple):
    """The mirror images of r coordinates: the parity of each, that of each packed entry of M, and χ.

    `signs` (2ᵏ, 2ᵏ) are χ_c(g), by g and c.
    """

    of_coordinates: NDArray[np.int64]
    of_entries: NDArray[np.int64]
    signs: Array

    @classmethod
    def of(cls, mirrors: Array) -> "Images":
        """Those of the planes (k, r), signs of the coordinates in each."""
        planes, r = mirrors.shape
        bits = 1 << np.arange(planes, dtype=np.int64)
        of_coordinates = np.array((mirrors < 0.0).astype(np.int64).T @ bits, dtype=np.int64)
        rows, columns = rows_and_columns(r)
        of_entries: NDArray[np.int64] = np.bitwise_xor(of_coordinates[rows], of_coordinates[columns])
        signs = np.ones((1, 1))
        for _ in range(planes):
            signs = np.block([[signs, signs], [signs, -signs]])
        return cls(of_coordinates, of_entries, signs)

    @property
    def number(self) -> int:
        """2ᵏ, itself included."""
        return len(self.signs)

    def transform(self, values: Array) -> Array:
        """Σ_g χ_c(g) values_g (2ᵏ, ...) over the first axis; twice over, it is 2ᵏ times the same."""
        transformed: Array = np.tensordot(self.signs, values, 1)
        return transformed

    def of_neurons(self, weights: Array, biases: Array, readout: Array) -> tuple[Array, Array, Array]:
        """Weights (r, h), biases (h,), readout (h, entries) of neurons with all their images beside them."""
        turned = self.signs[:, self.of_coordinates]  # (g, r)
        read = self.signs[:, self.of_entries]  # (g, entries)
        return (
            np.hstack([sign[:, None] * weights for sign in turned]),
            np.tile(biases, self.number),
            np.vstack([readout * sign for sign in read]),
        )


class MirroredNetworkKernel(NamedTuple):
    """Of the neurons without their images: `layer`, weights (r, h) and biases (h,); `readout` (entries, h).

    `constant` is F + Λ, packed; `stiffness` and `damping` are (r, r); parities are times h.
    """

    activation: NamedTuple
    layer: Array
    readout: Array
    constant: Array
    stiffness: Array
    damping: Array
    of_coordinates: NDArray[np.uint64]
    of_entries: NDArray[np.uint64]
    neurons: int


@njit(cache=True, **OPTIONS)
def transform(work, at, h, total):
    """The Walsh–Hadamard transform over the 2ᵏ pieces of h numbers from `at` on, in place."""
    span = h
    while span < total:
        for first in range(at, at + total, 2 * span):
            for k in range(span):
                a = work[first + k]
                b = work[first + span + k]
                work[first + k] = a + b
                work[first + span + k] = a - b
        span = span + span


@implements_rhs(MirroredNetworkKernel, inline=False)
def _mirrored_network(kernel, t, x, dx, work):
    activation, layer, readout, constant, stiffness, damping, of_coordinates, of_entries, neurons = kernel
    r = offset(of_coordinates.size)
    entries = offset(constant.size)
    h = offset(readout.size // constant.size)
    total = offset(neurons)
    # work: σ's arguments (later slopes), values, adjoints, each for every image; M; q̇
    z = offset(0)
    values = total
    adjoint = values + total
    matrix = adjoint + total
    rates = matrix + entries
    for k in range(h):
        work[k] = layer[r * h + k]
    for k in range(h, total):
        work[k] = 0.0
    for i in range(r):
        at = of_coordinates[i]
        for k in range(h):
            work[at + k] += layer[i * h + k] * x[i]
        work[rates + i] = x[r + i]
    transform(work, z, h, total)
    for k in range(total):
        work[values + k] = value(activation, work[k])
    for k in range(total):
        work[k] = slope(activation, work[k])
    transform(work, values, h, total)
    for e in range(entries):
        at = values + of_entries[e]
        row = e * h
        found = constant[e]
        for k in range(h):
            found += readout[row + k] * work[at + k]
        work[matrix + e] = found
    solve_packed(work, np.int64(matrix), np.int64(rates), np.int64(r))
    for k in range(total):
        work[adjoint + k] = 0.0
    # ½ ∂/∂q (q̇ᵀ M q̇) = Σ ½ q̇_i q̇_j ∂M_ij/∂q
    for i in range(r):
        dx[i] = work[rates + i]
    write_kinetic_adjoint(dx, r, work, matrix)
    for e in range(entries):
        at = adjoint + of_entries[e]
        row = e * h
        weight = work[matrix + e]
        for k in range(h):
            work[at + k] += weight * readout[row + k]
    transform(work, adjoint, h, total)
    for k in range(total):
        work[adjoint + k] *= work[k]
    transform(work, adjoint, h, total)
    for i in range(r):
        at = adjoint + of_coordinates[i]
        force = 0.0
        for k in range(h):
            force += layer[i * h + k] * work[at + k]
        dx[r + i] = force
    springs_and_dampers(stiffness, damping, x, dx)
