"""Compiled gradients of learned potentials of the coordinates."""

from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

from flexsurr.simulation.rhs import FLOATING_POINT, Array
from flexsurr.surrogates.activations import slope
from flexsurr.surrogates.layers import forward, offset

OPTIONS = {"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False}


class PolynomialPotential(NamedTuple):
    """Monomials of q times `inverse_q` (r,), built as in `PolynomialPortHamiltonianKernel`."""

    inverse_q: Array
    parents: NDArray[np.uint64]
    factors: NDArray[np.uint64]
    coefficients: Array


class NetworkPotential(NamedTuple):
    """One hidden layer: `layer` holds weights (r, n) and biases (n,), `readout` is (n,)."""

    activation: NamedTuple
    layer: Array
    readout: Array


def add_gradient(potential: Any, factor: float, x: Array, dx: Array, work: Array) -> None:
    """Add `factor` times the gradient at q, the first half of `x`, to the second half of `dx`.

    From compiled code only.
    """
    raise TypeError(f"no gradient is registered for {type(potential).__name__}; call it from compiled code")


def _polynomial(potential, factor, x, dx, work):
    inverse_q, parents, of_factors, coefficients = potential
    r = offset(inverse_q.size)
    slopes = r + r * (r + offset(1)) // offset(2)
    phi = slopes + slopes
    count = offset(coefficients.size)
    adjoint = phi + count
    place = r
    for i in range(r):
        work[i] = x[i] * inverse_q[i]
        for j in range(i + offset(1)):
            work[place] = work[i] * work[j]
            place += offset(1)
    for k in range(slopes):
        work[slopes + k] = 0.0
    work[phi] = 1.0
    work[adjoint] = 0.0
    for k in range(count - offset(1)):
        work[phi + k + offset(1)] = work[phi + parents[k]] * work[of_factors[k]]
        work[adjoint + k + offset(1)] = coefficients[k + offset(1)]
    for back in range(count - offset(1)):
        k = count - offset(2) - back
        a = work[adjoint + k + offset(1)]
        work[adjoint + parents[k]] += a * work[of_factors[k]]
        work[slopes + of_factors[k]] += a * work[phi + parents[k]]
    place = slopes + r
    for i in range(r):
        for j in range(i + offset(1)):
            work[slopes + i] += work[place] * work[j]
            work[slopes + j] += work[place] * work[i]
            place += offset(1)
    for i in range(r):
        dx[r + i] += factor * work[slopes + i] * inverse_q[i]


def _network(potential, factor, x, dx, work):
    activation, layer, readout = potential
    r = offset(x.size // 2)
    n = offset(readout.size)
    for i in range(r):
        work[i] = x[i]
    forward(layer, offset(0), r, n, work, offset(0), r)
    for k in range(n):
        work[r + k] = readout[k] * slope(activation, work[r + k])
    for i in range(r):
        total = 0.0
        row = i * n
        for k in range(n):
            total += layer[row + k] * work[r + k]
        dx[r + i] += factor * total


GRADIENTS = {PolynomialPotential: _polynomial, NetworkPotential: _network}


@overload(add_gradient, jit_options=OPTIONS)
def _gradient_of(potential, factor, x, dx, work):
    if isinstance(potential, types.BaseNamedTuple):
        return GRADIENTS.get(potential.instance_class)
    return None
