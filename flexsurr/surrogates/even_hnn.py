"""Hamiltonian network of products: even in q and even in p, whatever its weights.

A structure that is its own mirror image has H(−q, p) = H(q, p), and every H of a structure is even in p. A
network that takes products has both by construction; an `HNN` has to learn them, with more neurons.
"""

from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from flexsurr.simulation.dimension import LANES
from flexsurr.simulation.jacobian import implements_jacobian
from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.simulation.side_by_side import implements_rhs_of_block
from flexsurr.surrogates.activations import (
    ActivationFunction,
    activation_function,
    curvature,
    slope,
    two_slopes,
)
from flexsurr.surrogates.layers import Shapes, forward, layer_shapes, offset, size_of, views, write_products
from flexsurr.surrogates.packed import packed_size, rows_and_columns
from flexsurr.surrogates.scaling import FeatureScaling
from flexsurr.surrogates.surrogate import Surrogate, symplectic


@dataclass(frozen=True, eq=False)
class EvenHNN(Surrogate):
    """q̇ = ∂H/∂p, ṗ = −∂H/∂q with H = Σ_k c_k σ(w_k · s + b_k); s are the products q_i q_j, then p_i p_j.

    For one pair H = Σ_k c_k σ(a_k q² + d_k p² + b_k). `parameters`: weights (products, n), biases (n,) and
    c (n,).
    """

    hidden: tuple[int, ...]
    activation: str

    architecture: ClassVar[str] = "even_hnn"

    def __post_init__(self) -> None:
        if isinstance(self.scaling, FeatureScaling):
            raise ValueError("an even Hamiltonian network takes a canonical scaling")
        if len(self.hidden) != 1 or self.hidden[0] < 1:
            raise ValueError(f"an even Hamiltonian network takes one hidden layer, not {self.hidden}")
        activation_function(self.activation)  # refuses what is none
        super().__post_init__()

    @classmethod
    def shapes(cls, states: int, neurons: int) -> Shapes:
        """Shapes of the arrays in `parameters`, in their order."""
        return [*layer_shapes((2 * packed_size(states // 2), neurons)), (neurons,)]

    @property
    def parameter_count(self) -> int:
        """Weights, biases and readout."""
        return size_of(self.shapes(len(self.state_names), self.hidden[0]))

    @property
    def sigma(self) -> ActivationFunction:
        """The activation function."""
        return activation_function(self.activation)

    def arrays(self) -> list[Array]:
        """Views of the parameters in their shapes."""
        return views(self.parameters, self.shapes(len(self.state_names), self.hidden[0]))

    def scaled_energy(self, x: Array) -> Array:
        """Ĥ of scaled states, (..., 2r) -> (...), but for a constant."""
        weights, biases, readout = self.arrays()
        values: Array = self.sigma.value(products(x) @ weights + biases) @ readout
        return values

    def scaled_field(self, x: Array) -> Array:
        """Hamilton's equations of Ĥ."""
        weights, biases, readout = self.arrays()
        by_products = (self.sigma.slope(products(x) @ weights + biases) * readout) @ weights.T
        return symplectic(np.einsum("...ji,...i->...j", derivatives_of_products(x), by_products))

    def energy(self, x: Array) -> Array:
        """H(x) − H(0), (..., 2r) -> (...), in the product of the units of q and p per second."""
        scaled = x / self.scaling.states(len(self.state_names))
        return self.scaling.energy * (self.scaled_energy(scaled) - self.scaled_energy(np.zeros_like(scaled)))

    def kernel(self) -> tuple[NamedTuple, int]:
        """A single loop over the neurons for one pair (q, p), else the layer forth and back."""
        weights, biases, readout = self.arrays()
        weights = weights / products(self.scaling.states(len(self.state_names)))[:, None]
        readout = readout * self.scaling.energy
        if len(self.state_names) == 2:
            # ∂(q²)/∂q = 2 q: the two, and c, are in what is added up
            twice = 2.0 * readout * weights
            return PhasePlaneEvenHNN(
                self.sigma.tag, weights[0].copy(), weights[1].copy(), biases.copy(), twice[0], twice[1]
            ), 0
        layer = np.concatenate([weights.ravel(), biases])
        # of the right-hand side products and neurons; its Jacobian has more rows of these, one a state
        rows = 3 + len(self.state_names)
        return EvenHNNKernel(self.sigma.tag, layer, readout), len(weights) + rows * len(readout)

    def settings(self) -> dict[str, Any]:
        """Hidden layer and activation."""
        return {"hidden": list(self.hidden), "activation": self.activation}


def products(x: Array) -> Array:
    """q_i q_j, j ≤ i, then p_i p_j, of states x (..., 2r): (..., r (r + 1))."""
    rows, columns = rows_and_columns(x.shape[-1] // 2)
    q, p = np.split(x, 2, axis=-1)
    return np.concatenate([part[..., rows] * part[..., columns] for part in (q, p)], axis=-1)


def derivatives_of_products(x: Array) -> Array:
    """∂(product i)/∂x_j, (..., 2r) -> (..., j, i)."""
    r = x.shape[-1] // 2
    rows, columns = rows_and_columns(r)
    identity = np.eye(r)
    result = np.zeros((*x.shape, 2 * rows.size))
    for k, part in enumerate(np.split(x, 2, axis=-1)):
        by_part = part[..., None, rows] * identity[:, columns] + part[..., None, columns] * identity[:, rows]
        result[..., k * r : (k + 1) * r, k * rows.size : (k + 1) * rows.size] = by_part
    return result


class PhasePlaneEvenHNN(NamedTuple):
    """One pair (q, p), all (n,): weights of q² and of p², biases, and 2 c times each of the weights."""

    activation: NamedTuple
    w_q: Array
    w_p: Array
    bias: Array
    on_q: Array
    on_p: Array


@implements_rhs(PhasePlaneEvenHNN)
def _phase_plane_even_hnn(kernel, t, x, dx, work):
    activation, w_q, w_p, bias, on_q, on_p = kernel
    q, p = x[0], x[1]
    q_2, p_2 = q * q, p * p
    by_q = 0.0
    by_p = 0.0
    for k in range(offset(bias.size)):
        a = slope(activation, w_q[k] * q_2 + w_p[k] * p_2 + bias[k])
        by_q += a * on_q[k]
        by_p += a * on_p[k]
    dx[0] = by_p * p
    dx[1] = -by_q * q


@implements_jacobian(PhasePlaneEvenHNN)
def _jacobian_of_phase_plane_even_hnn(kernel, t, x, dx, jac, work):
    activation, w_q, w_p, bias, on_q, on_p = kernel
    q, p = x[0], x[1]
    by_q = by_p = by_qq = by_qp = by_pp = 0.0
    for k in range(bias.size):
        z = w_q[k] * q * q + w_p[k] * p * p + bias[k]
        a = slope(activation, z)
        bent = 2.0 * curvature(activation, z)
        by_q += a * on_q[k]
        by_p += a * on_p[k]
        by_qq += bent * on_q[k] * w_q[k]
        by_qp += bent * on_q[k] * w_p[k]
        by_pp += bent * on_p[k] * w_p[k]
    jac[0, 0], jac[0, 1] = q * p * by_qp, by_p + p * p * by_pp
    jac[1, 0], jac[1, 1] = -by_q - q * q * by_qq, -q * p * by_qp
    return 0


@implements_rhs_of_block(PhasePlaneEvenHNN, rows=2)
def _block_of_even_hnn(kernel, t, x, dx, work):
    activation, w_q, w_p, bias, on_q, on_p = kernel
    for b in range(2 * LANES):
        work[b] = x[b] * x[b]
        dx[b] = 0.0
    n = bias.size
    for k in range(1, n, 2):
        a_q, a_p, a_b, a_on_q, a_on_p = w_q[k - 1], w_p[k - 1], bias[k - 1], on_q[k - 1], on_p[k - 1]
        e_q, e_p, e_b, e_on_q, e_on_p = w_q[k], w_p[k], bias[k], on_q[k], on_p[k]
        for b in range(LANES):
            q_2, p_2 = work[b], work[LANES + b]
            a, e = two_slopes(activation, a_q * q_2 + a_p * p_2 + a_b, e_q * q_2 + e_p * p_2 + e_b)
            dx[b] += a * a_on_p + e * e_on_p
            dx[LANES + b] -= a * a_on_q + e * e_on_q
    if n % 2 == 1:
        a_q, a_p, a_b, a_on_q, a_on_p = w_q[n - 1], w_p[n - 1], bias[n - 1], on_q[n - 1], on_p[n - 1]
        for b in range(LANES):
            a = slope(activation, a_q * work[b] + a_p * work[LANES + b] + a_b)
            dx[b] += a * a_on_p
            dx[LANES + b] -= a * a_on_q
    for b in range(LANES):
        dx[b] *= x[LANES + b]
        dx[LANES + b] *= x[b]


class EvenHNNKernel(NamedTuple):
    """`layer`: weights (products, n), row by row, and biases (n,); `readout` (n,)."""

    activation: NamedTuple
    layer: Array
    readout: Array


@implements_rhs(EvenHNNKernel, inline=False)
def _even_hnn(kernel, t, x, dx, work):
    activation, layer, readout = kernel
    r = offset(x.size // 2)
    n = offset(readout.size)
    inputs = r * (r + offset(1))
    z = inputs
    write_products(x, offset(0), r, work, offset(0))
    write_products(x, r, r, work, inputs // offset(2))
    forward(layer, offset(0), inputs, n, work, offset(0), z)
    for k in range(n):
        work[z + k] = readout[k] * slope(activation, work[z + k])
    for i in range(x.size):
        dx[i] = 0.0
    e = offset(0)
    # ∂H/∂q belongs to ṗ, ∂H/∂p to q̇
    for first, into, sign in ((offset(0), r, -1.0), (r, offset(0), 1.0)):
        for i in range(r):
            for j in range(i + offset(1)):
                row = e * n
                total = 0.0
                for k in range(n):
                    total += layer[row + k] * work[z + k]
                dx[into + i] += sign * total * x[first + j]
                dx[into + j] += sign * total * x[first + i]
                e += offset(1)


@implements_jacobian(EvenHNNKernel)
def _jacobian_of_even_hnn(kernel, t, x, dx, jac, work):
    activation, layer, readout = kernel
    d = offset(x.size)
    r = d // offset(2)
    n = offset(readout.size)
    inputs = r * (r + offset(1))
    # work: products, arguments, c σ′, c σ″, and ∂z/∂x_i row by row
    z = inputs
    slopes = z + n
    bends = slopes + n
    by_x = bends + n
    write_products(x, offset(0), r, work, offset(0))
    write_products(x, r, r, work, inputs // offset(2))
    forward(layer, offset(0), inputs, n, work, offset(0), z)
    for k in range(n):
        work[slopes + k] = readout[k] * slope(activation, work[z + k])
    for k in range(n):
        work[bends + k] = readout[k] * curvature(activation, work[z + k])
    for k in range(d * n):
        work[by_x + k] = 0.0
    e = offset(0)
    for first in (offset(0), r):
        for i in range(r):
            for j in range(i + offset(1)):
                row = e * n
                for k in range(n):
                    work[by_x + (first + i) * n + k] += layer[row + k] * x[first + j]
                    work[by_x + (first + j) * n + k] += layer[row + k] * x[first + i]
                e += offset(1)
    # the Hessian of H in the place of the Jacobian, then turned by Hamilton's equations
    for i in range(d):
        for j in range(i + offset(1)):
            total = 0.0
            for k in range(n):
                total += work[bends + k] * work[by_x + i * n + k] * work[by_x + j * n + k]
            jac[i, j] = total
            jac[j, i] = total
    e = offset(0)
    for first in (offset(0), r):
        for i in range(r):
            for j in range(i + offset(1)):
                total = 0.0
                for k in range(n):
                    total += work[slopes + k] * layer[e * n + k]
                jac[first + i, first + j] += total
                jac[first + j, first + i] += total
                e += offset(1)
    for i in range(r):
        for j in range(d):
            by_q = jac[i, j]
            jac[i, j] = jac[r + i, j]
            jac[r + i, j] = -by_q
    return 0
