"""Derivatives of a network's field with respect to its weights, in closed form and compiled.

For one sample, any depth, in the layout of `Network.parameters`:

    propagate(kernel, x, work)              value, slope and curvature of every neuron at x
    field(kernel, work, dx)                 the scaled field f, from what `propagate` left
    accumulate(kernel, v, gradient, work)   gradient += ∂(v · f)/∂θ, from what `propagate` left

The Hamiltonian network's f is itself a derivative: v · f = u · ∇H with u = (−v_p, v_q). The dissipative
one's is v · f = u · ∇H + v · ∇D.

The workspace holds, for each network, a block of five vectors for the inputs and for each layer (values,
tangents, slopes, curvatures, adjoints of σ's arguments), then two vectors of adjoints of the widest layer's
length. Offsets into it are unsigned for the reason given in `flexsurr.surrogates.layers`.
"""

from typing import Any

import numpy as np
from numba import njit
from numba.extending import overload

from flexsurr.simulation.rhs import FLOATING_POINT, Array
from flexsurr.surrogates.activations import curvature, slope, value
from flexsurr.surrogates.hnn import DissipativeHNNKernel, HNNKernel
from flexsurr.surrogates.layers import back, forward, offset
from flexsurr.surrogates.mlp import MLPKernel

VECTORS = np.uint64(5)  # in a block
# without reference counts: nothing here allocates, and they would cost as much as a small network
OPTIONS = {"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False}


def workspace(widths: tuple[int, ...], networks: int) -> Array:
    """Room for one sample in each of `networks` of these widths, inputs first."""
    return np.zeros(networks * (int(VECTORS) * sum(widths) + 2 * max(widths)))


@njit(**OPTIONS)
def propagate(kernel, parameters, x, work):
    """Value, slope and curvature of every neuron at the scaled state `x` (2r,)."""
    activation = kernel.activation
    widths = kernel.widths
    for network in range(kernel.networks):
        layer, block = starts(kernel, network, parameters, work)
        for j in range(x.size):
            work[block + offset(j)] = x[j]
        for level in range(1, len(widths)):
            n = offset(widths[level - 1])
            m = offset(widths[level])
            inputs = block
            block += VECTORS * n
            slopes = block + m + m
            curvatures = slopes + m
            forward(parameters, layer, n, m, work, inputs, block)
            for k in range(m):
                z = work[block + k]
                work[block + k] = value(activation, z)
                work[slopes + k] = slope(activation, z)
                work[curvatures + k] = curvature(activation, z)
            layer += n * m + m


@njit(**OPTIONS)
def starts(kernel, network, parameters, work):
    """Offsets of the first parameter and of the workspace of one of the kernel's networks."""
    networks = kernel.networks
    return offset(network * (parameters.size // networks)), offset(network * (work.size // networks))


@njit(**OPTIONS)
def ends(widths, layer, block):
    """Offsets of the last layer's block, of the readout's parameters and of the two adjoints.

    Of the network whose parameters begin at `layer` and whose workspace begins at `block`.
    """
    widest = offset(0)
    for level in range(1, len(widths)):
        n = offset(widths[level - 1])
        m = offset(widths[level])
        layer += n * m + m
        block += VECTORS * n
        widest = max(widest, n, m)
    adjoint = block + VECTORS * offset(widths[len(widths) - 1])
    return block, layer, adjoint, adjoint + widest


@njit(**OPTIONS)
def scalar_gradient(kernel, parameters, network, work):
    """Gradient of the scalar of number `network` by the inputs; returns its offset in `work`.

    From what `propagate` left; the next call overwrites it.
    """
    widths = kernel.widths
    last = len(widths) - 1
    block, layer, adjoint, _ = ends(widths, *starts(kernel, network, parameters, work))
    for k in range(offset(widths[last])):
        work[adjoint + k] = parameters[layer + k]
    for level in range(last, 0, -1):
        n = offset(widths[level - 1])
        m = offset(widths[level])
        slopes = block + m + m
        arguments = slopes + m + m
        for k in range(m):
            work[arguments + k] = work[adjoint + k] * work[slopes + k]
        layer -= n * m + m
        back(parameters, layer, n, m, work, arguments, adjoint)
        block -= VECTORS * n
    return adjoint


@njit(**OPTIONS)
def accumulate_slope(kernel, parameters, network, gradient, work):
    """Add ∂(u · ∇ scalar)/∂θ of the scalar of number `network` to `gradient`.

    u is its inputs' tangents in `work`.

    u · ∇ is the rate at which the scalar changes along u: one tangent sweep forwards, then one ordinary
    sweep back. Values, slopes and curvatures stay as `propagate` left them.
    """
    widths = kernel.widths
    last = len(widths) - 1
    layer, block = starts(kernel, network, parameters, work)
    _, _, of_values, of_tangents = ends(widths, layer, block)
    for level in range(1, last + 1):
        n = offset(widths[level - 1])
        m = offset(widths[level])
        tangents_in = block + n
        block += VECTORS * n
        tangents = block + m
        slopes = tangents + m
        curvatures = slopes + m
        arguments = curvatures + m
        for k in range(m):
            work[tangents + k] = 0.0
        for j in range(n):
            tangent = work[tangents_in + j]
            row = layer + j * m
            for k in range(m):
                work[tangents + k] += tangent * parameters[row + k]
        for k in range(m):
            work[arguments + k] = work[curvatures + k] * work[tangents + k]
            work[tangents + k] *= work[slopes + k]
        layer += n * m + m
    m = offset(widths[last])
    for k in range(m):
        gradient[layer + k] += work[block + m + k]
        work[of_values + k] = 0.0
        work[of_tangents + k] = parameters[layer + k]
    for level in range(last, 0, -1):
        n = offset(widths[level - 1])
        m = offset(widths[level])
        tangents = block + m
        slopes = tangents + m
        arguments = slopes + m + m
        # the adjoints of σ's argument and of that argument's tangent take the places of both
        for k in range(m):
            work[arguments + k] = (
                work[of_values + k] * work[slopes + k] + work[of_tangents + k] * work[arguments + k]
            )
            work[tangents + k] = work[of_tangents + k] * work[slopes + k]
        block -= VECTORS * n
        biases = layer - m
        layer = biases - n * m
        for k in range(m):
            gradient[biases + k] += work[arguments + k]
        for j in range(n):
            a = work[block + j]
            tangent = work[block + n + j]
            row = layer + j * m
            for k in range(m):
                gradient[row + k] += a * work[arguments + k] + tangent * work[tangents + k]
        if level > 1:
            back(parameters, layer, n, m, work, arguments, of_values)
            back(parameters, layer, n, m, work, tangents, of_tangents)


def field(kernel: Any, parameters: Array, work: Array, dx: Array) -> None:
    """Write the scaled field into `dx` (2r,); from compiled code only."""
    raise TypeError("field is for compiled code")


def accumulate(kernel: Any, parameters: Array, v: Array, gradient: Array, work: Array) -> None:
    """Add ∂(v · f)/∂θ to `gradient`; from compiled code only."""
    raise TypeError("accumulate is for compiled code")


@njit(**OPTIONS)
def hamiltonian_field(kernel, parameters, work, dx):
    """Hamilton's equations of the first scalar, into `dx`."""
    h = scalar_gradient(kernel, parameters, 0, work)
    r = offset(dx.size // 2)
    for j in range(r):
        dx[j] = work[h + r + j]
        dx[r + j] = -work[h + j]


@njit(**OPTIONS)
def accumulate_hamiltonian(kernel, parameters, v, gradient, work):
    """Add the derivatives of `v` · `hamiltonian_field` to `gradient`."""
    r = offset(v.size // 2)
    for j in range(r):
        work[r + r + j] = -v[r + j]
        work[r + r + r + j] = v[j]
    accumulate_slope(kernel, parameters, 0, gradient, work)


def _hnn_field(kernel, parameters, work, dx):
    hamiltonian_field(kernel, parameters, work, dx)


def _hnn_accumulate(kernel, parameters, v, gradient, work):
    accumulate_hamiltonian(kernel, parameters, v, gradient, work)


def _dissipative_hnn_field(kernel, parameters, work, dx):
    hamiltonian_field(kernel, parameters, work, dx)
    d = scalar_gradient(kernel, parameters, 1, work)
    for j in range(offset(dx.size)):
        dx[j] += work[d + j]


def _dissipative_hnn_accumulate(kernel, parameters, v, gradient, work):
    accumulate_hamiltonian(kernel, parameters, v, gradient, work)
    _, block = starts(kernel, 1, parameters, work)
    count = offset(v.size)
    for j in range(count):
        work[block + count + j] = v[j]
    accumulate_slope(kernel, parameters, 1, gradient, work)


def _mlp_field(kernel, parameters, work, dx):
    widths = kernel.widths
    block, layer, _, outputs = ends(widths, offset(0), offset(0))
    d = offset(dx.size)
    forward(parameters, layer, offset(widths[len(widths) - 1]), d, work, block, outputs)
    for i in range(d):
        dx[i] = work[outputs + i]


def _mlp_accumulate(kernel, parameters, v, gradient, work):
    widths = kernel.widths
    last = len(widths) - 1
    block, layer, adjoint, outputs = ends(widths, offset(0), offset(0))
    n = offset(widths[last])
    d = offset(v.size)
    for i in range(d):
        work[outputs + i] = v[i]
        gradient[layer + n * d + i] += v[i]
    for j in range(n):
        row = layer + j * d
        for i in range(d):
            gradient[row + i] += work[block + j] * work[outputs + i]
    back(parameters, layer, n, d, work, outputs, adjoint)
    for level in range(last, 0, -1):
        n = offset(widths[level - 1])
        m = offset(widths[level])
        slopes = block + m + m
        arguments = slopes + m + m
        for k in range(m):
            work[arguments + k] = work[adjoint + k] * work[slopes + k]
        block -= VECTORS * n
        biases = layer - m
        layer = biases - n * m
        for k in range(m):
            gradient[biases + k] += work[arguments + k]
        for j in range(n):
            a = work[block + j]
            row = layer + j * m
            for k in range(m):
                gradient[row + k] += a * work[arguments + k]
        if level > 1:
            back(parameters, layer, n, m, work, arguments, adjoint)


@overload(field, jit_options=OPTIONS)
def _field_of(kernel, parameters, work, dx):
    return FIELDS.get(kernel.instance_class)


@overload(accumulate, jit_options=OPTIONS)
def _accumulate_of(kernel, parameters, v, gradient, work):
    return ADJOINTS.get(kernel.instance_class)


FIELDS = {HNNKernel: _hnn_field, DissipativeHNNKernel: _dissipative_hnn_field, MLPKernel: _mlp_field}
ADJOINTS = {
    HNNKernel: _hnn_accumulate,
    DissipativeHNNKernel: _dissipative_hnn_accumulate,
    MLPKernel: _mlp_accumulate,
}
