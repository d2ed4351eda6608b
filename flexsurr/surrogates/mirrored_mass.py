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

from flexsurr.simulation.jacobian import implements_jacobian
from flexsurr.simulation.linear_solvers import invert_packed, solve_packed
from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.surrogates.activations import curvature, slope, value
from flexsurr.surrogates.layers import offset
from flexsurr.surrogates.packed import OPTIONS, rows_and_columns
from flexsurr.surrogates.port_hamiltonian import (
    jacobian_of_motion,
    springs_and_dampers,
    write_kinetic_adjoint,
)


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

    `constant` is F + Λ, packed; `stiffness` and `damping` are (r, r); parities are times h. `of_slopes`
    (r · entries,) are those of the entries' derivatives by each coordinate.
    """

    activation: NamedTuple
    layer: Array
    readout: Array
    constant: Array
    stiffness: Array
    damping: Array
    of_coordinates: NDArray[np.uint64]
    of_entries: NDArray[np.uint64]
    of_slopes: NDArray[np.uint64]
    neurons: int


def mirrored_kernel(
    images: Images,
    activation: NamedTuple,
    neurons: tuple[Array, Array, Array],
    constant: Array,
    stiffness: Array,
    damping: Array,
) -> tuple[NamedTuple, int]:
    """The kernel of `neurons` without their images, and the size of its workspace.

    They are weights (r, h), biases (h,) and readout (entries, h).
    """
    weights, biases, readout = neurons
    r, h = weights.shape
    total, entries = h * images.number, len(readout)
    of_slopes = images.of_coordinates[:, None] ^ images.of_entries
    kernel = MirroredNetworkKernel(
        activation,
        np.concatenate([weights.ravel(), biases]),
        readout.ravel(),
        constant,
        np.ascontiguousarray(stiffness).ravel(),
        np.ascontiguousarray(damping).ravel(),
        (h * images.of_coordinates).astype(np.uint64),
        (h * images.of_entries).astype(np.uint64),
        (h * of_slopes).astype(np.uint64).ravel(),
        total,
    )
    # of the right-hand side 3 total + entries + r; its Jacobian needs more
    return kernel, 4 * total + entries + 3 * r * r


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


@njit(forceinline=True, **OPTIONS)
def _write_arguments(kernel, x, r, h, total, work):
    """What σ is taken of, at the start of `work`, image by image."""
    layer, of_coordinates = kernel.layer, kernel.of_coordinates
    for k in range(h):
        work[k] = layer[r * h + k]
    for k in range(h, total):
        work[k] = 0.0
    for i in range(r):
        at = of_coordinates[i]
        for k in range(h):
            work[at + k] += layer[i * h + k] * x[i]
    transform(work, offset(0), h, total)


@njit(forceinline=True, **OPTIONS)
def _write_mass(kernel, h, total, values, matrix, work):
    """The packed M at `matrix` of the neurons' values, which are overwritten."""
    readout, constant, of_entries = kernel.readout, kernel.constant, kernel.of_entries
    transform(work, values, h, total)
    for e in range(offset(constant.size)):
        at = values + of_entries[e]
        row = e * h
        found = constant[e]
        for k in range(h):
            found += readout[row + k] * work[at + k]
        work[matrix + e] = found


@njit(forceinline=True, **OPTIONS)
def _write_adjoint(kernel, h, total, weights, adjoint, work):
    """Derivatives by the neurons' values of the entries of M times their weights, at `weights`."""
    readout, of_entries = kernel.readout, kernel.of_entries
    for k in range(total):
        work[adjoint + k] = 0.0
    for e in range(offset(of_entries.size)):
        at = adjoint + of_entries[e]
        row = e * h
        weight = work[weights + e]
        for k in range(h):
            work[at + k] += weight * readout[row + k]
    transform(work, adjoint, h, total)


@implements_rhs(MirroredNetworkKernel, inline=False)
def _mirrored_network(kernel, t, x, dx, work):
    activation, layer, of_coordinates = kernel.activation, kernel.layer, kernel.of_coordinates
    r = offset(of_coordinates.size)
    entries = offset(kernel.constant.size)
    h = offset(kernel.readout.size // kernel.constant.size)
    total = offset(kernel.neurons)
    # work: σ's arguments (later slopes), values, adjoints, each for every image; M; q̇
    values = total
    adjoint = values + total
    matrix = adjoint + total
    rates = matrix + entries
    _write_arguments(kernel, x, r, h, total, work)
    for k in range(total):
        work[values + k] = value(activation, work[k])
    for k in range(total):
        work[k] = slope(activation, work[k])
    _write_mass(kernel, h, total, values, matrix, work)
    for i in range(r):
        work[rates + i] = x[r + i]
    solve_packed(work, np.int64(matrix), np.int64(rates), np.int64(r))
    for i in range(r):
        dx[i] = work[rates + i]
    # ½ ∂/∂q (q̇ᵀ M q̇) = Σ ½ q̇_i q̇_j ∂M_ij/∂q
    write_kinetic_adjoint(dx, r, work, matrix)
    _write_adjoint(kernel, h, total, matrix, adjoint, work)
    for k in range(total):
        work[adjoint + k] *= work[k]
    transform(work, adjoint, h, total)
    for i in range(r):
        at = adjoint + of_coordinates[i]
        force = 0.0
        for k in range(h):
            force += layer[i * h + k] * work[at + k]
        dx[r + i] = force
    springs_and_dampers(kernel.stiffness, kernel.damping, x, dx)


@implements_jacobian(MirroredNetworkKernel)
def _jacobian_of_mirrored_network(kernel, t, x, dx, jac, work):
    activation, layer, readout = kernel.activation, kernel.layer, kernel.readout
    of_entries, of_slopes = kernel.of_entries, kernel.of_slopes
    r = offset(kernel.of_coordinates.size)
    entries = offset(kernel.constant.size)
    h = offset(kernel.readout.size // kernel.constant.size)
    total = offset(kernel.neurons)
    # work: σ's arguments (later slopes), values, adjoints, curvatures, each for every image; M; M⁻¹,
    # (∂M/∂q_k) q̇ column by column, ½ ∂²/∂q∂q (q̇ᵀ M q̇)
    values = total
    adjoint = values + total
    bends = adjoint + total
    matrix = bends + total
    inverse = matrix + entries
    turned = inverse + r * r
    curved = turned + r * r
    _write_arguments(kernel, x, r, h, total, work)
    for k in range(total):
        work[values + k] = value(activation, work[k])
    for k in range(total):
        work[bends + k] = curvature(activation, work[k])
    for k in range(total):
        work[k] = slope(activation, work[k])
    _write_mass(kernel, h, total, values, matrix, work)
    invert_packed(work, np.int64(matrix), np.int64(inverse), np.int64(r))
    # the signs of two coordinates are together those of an entry: sums over images come transformed
    write_kinetic_adjoint(dx, r, work, matrix)
    _write_adjoint(kernel, h, total, matrix, adjoint, work)
    for k in range(total):
        work[bends + k] *= work[adjoint + k]
    transform(work, bends, h, total)
    transform(work, offset(0), h, total)
    for i in range(r * r):
        work[turned + i] = 0.0
    e = offset(0)
    for i in range(r):
        for j in range(i + offset(1)):
            bent = bends + of_entries[e]
            found = 0.0
            for k in range(h):
                found += layer[i * h + k] * layer[j * h + k] * work[bent + k]
            work[curved + i * r + j] = found
            work[curved + j * r + i] = found
            for m in range(r):
                at = of_slopes[m * entries + e]
                by_q = 0.0
                for k in range(h):
                    by_q += readout[e * h + k] * layer[m * h + k] * work[at + k]
                work[turned + i * r + m] += by_q * dx[j]
                if i != j:
                    work[turned + j * r + m] += by_q * dx[i]
            e += offset(1)
    jacobian_of_motion(kernel.stiffness, kernel.damping, work, inverse, turned, curved, jac)
    return 0
