"""Compiled learned maps of the coordinates."""

from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

from flexsurr.simulation.rhs import FLOATING_POINT, Array
from flexsurr.surrogates.activations import value
from flexsurr.surrogates.layers import forward, offset

OPTIONS = {"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False}


class PolynomialMapKernel(NamedTuple):
    """Monomials of q times `inverse_q` (r,), built as in `PolynomialPortHamiltonianKernel`.

    `coefficients` holds those of the first output, then those of the next.
    """

    inverse_q: Array
    parents: NDArray[np.uint64]
    factors: NDArray[np.uint64]
    coefficients: Array


class NetworkMapKernel(NamedTuple):
    """One hidden layer: `layer` holds weights (r, n) and biases (n,), `readout` is (m, n) row by row."""

    activation: NamedTuple
    layer: Array
    readout: Array
    constant: Array


def add_outputs(kernel: Any, factor: float, x: Array, dx: Array, work: Array) -> None:
    """Add `factor` times the map of q, the first half of `x`, to the second half of `dx`.

    The map must have as many outputs as coordinates. From compiled code only.
    """
    raise TypeError(f"no map is registered for {type(kernel).__name__}; call it from compiled code")


def _polynomial(kernel, factor, x, dx, work):
    inverse_q, parents, of_factors, coefficients = kernel
    r = offset(inverse_q.size)
    phi = r + r * (r + offset(1)) // offset(2)
    count = offset(parents.size + 1)
    place = r
    for i in range(r):
        work[i] = x[i] * inverse_q[i]
        for j in range(i + offset(1)):
            work[place] = work[i] * work[j]
            place += offset(1)
    work[phi] = 1.0
    for k in range(count - offset(1)):
        work[phi + k + offset(1)] = work[phi + parents[k]] * work[of_factors[k]]
    for i in range(r):
        total = 0.0
        row = i * count
        for k in range(count):
            total += coefficients[row + k] * work[phi + k]
        dx[r + i] += factor * total


def _network(kernel, factor, x, dx, work):
    activation, layer, readout, constant = kernel
    r = offset(constant.size)
    n = offset(readout.size) // r
    for i in range(r):
        work[i] = x[i]
    forward(layer, offset(0), r, n, work, offset(0), r)
    for k in range(n):
        work[r + k] = value(activation, work[r + k])
    for i in range(r):
        total = constant[i]
        row = i * n
        for k in range(n):
            total += readout[row + k] * work[r + k]
        dx[r + i] += factor * total


OUTPUTS = {PolynomialMapKernel: _polynomial, NetworkMapKernel: _network}


@overload(add_outputs, jit_options=OPTIONS)
def _outputs_of(kernel, factor, x, dx, work):
    if isinstance(kernel, types.BaseNamedTuple):
        return OUTPUTS.get(kernel.instance_class)
    return None
