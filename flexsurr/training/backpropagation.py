"""Derivatives of a network's field with respect to its weights, in closed form and compiled.

For one sample, any depth, in the layout of `Network.parameters`:

    propagate(kernel, x, work)              value, slope and curvature of every neuron at x
    field(kernel, work, dx)                 the scaled field f, from what `propagate` left
    accumulate(kernel, v, gradient, work)   gradient += ∂(v · f)/∂θ, from what `propagate` left

The Hamiltonian network's f is itself a derivative. Since v · f = u · ∇H with u = (−v_p, v_q), it is
the rate at which H changes along u: one tangent sweep forwards, then one ordinary sweep back.

The workspace holds a block of five vectors for the inputs and for each layer (values, tangents,
slopes, curvatures, adjoints of σ's arguments), then two vectors of adjoints of the widest layer's
length. Offsets into it are unsigned for the reason given in `flexsurr.surrogates.layers`.
"""

from typing import Any

import numpy as np
from numba import njit
from numba.extending import overload

from flexsurr.simulation.rhs import FLOATING_POINT, Array
from flexsurr.surrogates.activations import curvature, slope, value
from flexsurr.surrogates.hnn import HNNKernel
from flexsurr.surrogates.layers import back, forward, offset
from flexsurr.surrogates.mlp import MLPKernel

VECTORS = np.uint64(5)  # in a block
# without reference counts: nothing here allocates, and they would cost as much as a small network
OPTIONS = {"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False}


def workspace(widths: tuple[int, ...]) -> Array:
    """Room for one sample in a network of these widths, inputs first."""
    return np.zeros(int(VECTORS) * sum(widths) + 2 * max(widths))


def field(kernel: Any, parameters: Array, work: Array, dx: Array) -> None:
    """Write the scaled field into `dx` (2r,); from compiled code only."""
    raise TypeError("field is for compiled code")


def accumulate(kernel: Any, parameters: Array, v: Array, gradient: Array, work: Array) -> None:
    """Add ∂(v · f)/∂θ to `gradient`; from compiled code only."""
    raise TypeError("accumulate is for compiled code")


@njit(**OPTIONS)
def propagate(kernel, parameters, x, work):
    """Value, slope and curvature of every neuron at the scaled state `x` (2r,)."""
    activation = kernel.activation
    widths = kernel.widths
    for j in range(x.size):
        work[j] = x[j]
    block = offset(0)
    layer = offset(0)
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
def _ends(widths):
    """Offsets of the last layer's block, of the readout's parameters and of the two adjoints."""
    layer = offset(0)
    block = offset(0)
    widest = offset(0)
    for level in range(1, len(widths)):
        n = offset(widths[level - 1])
        m = offset(widths[level])
        layer += n * m + m
        block += VECTORS * n
        widest = max(widest, n, m)
    adjoint = block + VECTORS * offset(widths[len(widths) - 1])
    return block, layer, adjoint, adjoint + widest


def _hnn_field(kernel, parameters, work, dx):
    widths = kernel.widths
    last = len(widths) - 1
    block, layer, adjoint, _ = _ends(widths)
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
    r = offset(dx.size // 2)
    for j in range(r):
        dx[j] = work[adjoint + r + j]
        dx[r + j] = -work[adjoint + j]


def _hnn_accumulate(kernel, parameters, v, gradient, work):
    widths = kernel.widths
    last = len(widths) - 1
    r = offset(widths[0] // 2)
    for j in range(r):
        work[r + r + j] = -v[r + j]
        work[r + r + r + j] = v[j]
    block = offset(0)
    layer = offset(0)
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
    _, _, of_values, of_tangents = _ends(widths)
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


def _mlp_field(kernel, parameters, work, dx):
    widths = kernel.widths
    block, layer, _, outputs = _ends(widths)
    d = offset(dx.size)
    forward(parameters, layer, offset(widths[len(widths) - 1]), d, work, block, outputs)
    for i in range(d):
        dx[i] = work[outputs + i]


def _mlp_accumulate(kernel, parameters, v, gradient, work):
    widths = kernel.widths
    last = len(widths) - 1
    block, layer, adjoint, outputs = _ends(widths)
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
    return _by_architecture(kernel, _hnn_field, _mlp_field)


@overload(accumulate, jit_options=OPTIONS)
def _accumulate_of(kernel, parameters, v, gradient, work):
    return _by_architecture(kernel, _hnn_accumulate, _mlp_accumulate)


def _by_architecture(kernel: Any, hnn: Any, mlp: Any) -> Any:
    return {HNNKernel: hnn, MLPKernel: mlp}.get(kernel.instance_class)
