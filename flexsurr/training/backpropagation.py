"""Derivatives of a network's field with respect to its weights, in closed form and compiled.

For one sample, any depth, in the layout of `Network.parameters`:

    propagate(kernel, x, work)              value, slope and curvature of every neuron at x
    field(kernel, work, dx)                 the scaled field f, from what `propagate` left
    accumulate(kernel, v, gradient, work)   gradient += ∂(v · f)/∂θ, from what `propagate` left

The Hamiltonian network's f is itself a derivative: v · f = u · ∇H with u = (−v_p, v_q). The dissipative
one's is v · f = u · ∇H + v · ∇D.
"""

from typing import Any

from numba import njit
from numba.extending import overload

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.dissipative_hnn import DissipativeHNNKernel
from flexsurr.surrogates.hnn import HNNKernel
from flexsurr.surrogates.layers import back, forward, offset
from flexsurr.surrogates.mlp import MLPKernel
from flexsurr.training.forward_pass import OPTIONS, VECTORS, ends, starts
from flexsurr.training.scalar_gradients import accumulate_slope, scalar_gradient


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
