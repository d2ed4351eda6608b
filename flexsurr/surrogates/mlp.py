"""Multilayer perceptron: ẋ as a network of x, with no structure (the paper's Fig. 5)."""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from flexsurr.simulation.dimension import LANES
from flexsurr.simulation.jacobian import implements_jacobian
from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.simulation.side_by_side import implements_rhs_of_block
from flexsurr.surrogates.activations import slope, value
from flexsurr.surrogates.layers import Dense, Network, Shapes, add_products, forward, layer_shapes, offset
from flexsurr.surrogates.scaling import origins


@dataclass(frozen=True, eq=False)
class MLP(Network):
    """ẋ = W₂ σ(W₁ x + b₁) + b₂, or the same with more hidden layers."""

    architecture: ClassVar[str] = "mlp"
    paired: ClassVar[bool] = False

    @classmethod
    def readout_shapes(cls, states: int, neurons: int) -> Shapes:
        """Weights and biases of the outputs."""
        return layer_shapes((neurons, states))

    def scaled_field(self, x: Array) -> Array:
        """The network."""
        *hidden, readout, constants = self.arrays()
        return Dense(self.sigma, hidden, readout, constants)(x)

    def scaled_kernel(self, parameters: Array) -> "MLPKernel":
        """The scaled field with these weights, for compiled code."""
        return MLPKernel(self.sigma.tag, self.widths, parameters)

    def kernel(self) -> tuple[NamedTuple, int]:
        """A single loop for one hidden layer over one pair (q, p), else layer by layer."""
        count = len(self.state_names)
        x_from, dx_from = origins(self.scaling, count)
        inner, biases, *others, weights_out, biases_out = self.arrays()
        inner = inner / self.scaling.states(count)[:, None]
        others = [biases - x_from @ inner, *others]
        weights_out = weights_out * self.scaling.rates(count)
        biases_out = biases_out * self.scaling.rates(count) + dx_from
        if self.widths == (2, self.hidden[0]):
            vectors = inner[0], inner[1], others[0], weights_out[:, 0], weights_out[:, 1], biases_out
            return PhasePlaneMLP(self.sigma.tag, *(vector.copy() for vector in vectors)), 0
        parameters = np.concatenate([array.ravel() for array in (inner, *others, weights_out, biases_out)])
        return self.scaled_kernel(parameters), 2 * sum(self.widths)


class PhasePlaneMLP(NamedTuple):
    """One hidden layer over a single pair (q, p): weights and biases (n,), output biases (2,)."""

    activation: NamedTuple
    w_q: Array
    w_p: Array
    bias: Array
    to_dq: Array
    to_dp: Array
    bias_out: Array


@implements_rhs(PhasePlaneMLP)
def _phase_plane_mlp(kernel, t, x, dx, work):
    activation, w_q, w_p, bias, to_dq, to_dp, bias_out = kernel
    q, p = x[0], x[1]
    dq = 0.0
    dp = 0.0
    for k in range(bias.size):
        a = value(activation, w_q[k] * q + w_p[k] * p + bias[k])
        dq += a * to_dq[k]
        dp += a * to_dp[k]
    dx[0] = dq + bias_out[0]
    dx[1] = dp + bias_out[1]


@implements_jacobian(PhasePlaneMLP)
def _jacobian_of_phase_plane_mlp(kernel, t, x, dx, jac, work):
    activation, w_q, w_p, bias, to_dq, to_dp, _ = kernel
    q, p = x[0], x[1]
    q_by_q = q_by_p = p_by_q = p_by_p = 0.0
    for k in range(bias.size):
        a = slope(activation, w_q[k] * q + w_p[k] * p + bias[k])
        by_q, by_p = a * w_q[k], a * w_p[k]
        q_by_q += to_dq[k] * by_q
        q_by_p += to_dq[k] * by_p
        p_by_q += to_dp[k] * by_q
        p_by_p += to_dp[k] * by_p
    jac[0, 0], jac[0, 1] = q_by_q, q_by_p
    jac[1, 0], jac[1, 1] = p_by_q, p_by_p
    return 0


@implements_rhs_of_block(PhasePlaneMLP)
def _block_of_mlp(kernel, t, x, dx, work):
    activation, w_q, w_p, bias, to_dq, to_dp, bias_out = kernel
    q_out, p_out = bias_out[0], bias_out[1]
    for b in range(LANES):
        dx[b] = q_out
        dx[LANES + b] = p_out
    for k in range(bias.size):
        of_q, of_p, of_1, on_q, on_p = w_q[k], w_p[k], bias[k], to_dq[k], to_dp[k]
        for b in range(LANES):
            a = value(activation, of_q * x[b] + of_p * x[LANES + b] + of_1)
            dx[b] += a * on_q
            dx[LANES + b] += a * on_p


class MLPKernel(NamedTuple):
    """Any number of states and hidden layers; widths and parameters as in `Network`."""

    activation: NamedTuple
    widths: tuple[int, ...]
    parameters: Array
    networks: int = 1


@implements_rhs(MLPKernel, inline=False)
def _mlp(kernel, t, x, dx, work):
    activation, widths, parameters, _ = kernel
    # work: the inputs, then each layer's values, then the outputs
    for j in range(x.size):
        work[j] = x[j]
    values = offset(0)
    weights = offset(0)
    for layer in range(1, len(widths)):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        forward(parameters, weights, n, m, work, values, values + n)
        values += n
        weights += n * m + m
        for k in range(m):
            work[values + k] = value(activation, work[values + k])
    n = offset(widths[len(widths) - 1])
    forward(parameters, weights, n, offset(x.size), work, values, values + n)
    for i in range(x.size):
        dx[i] = work[values + n + offset(i)]


@implements_jacobian(MLPKernel)
def _jacobian_of_mlp(kernel, t, x, dx, jac, work):
    activation, widths, parameters, _ = kernel
    d = offset(x.size)
    # work: the inputs, of each layer σ′ and values, later tangents, then the outputs' tangents
    for j in range(x.size):
        work[j] = x[j]
    inputs = offset(0)
    row = d
    weights = offset(0)
    for layer in range(1, len(widths)):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        forward(parameters, weights, n, m, work, inputs, row)
        weights += n * m + m
        inputs = row + m
        for k in range(m):
            work[inputs + k] = value(activation, work[row + k])
        for k in range(m):
            work[row + k] = slope(activation, work[row + k])
        row = inputs + m
    for j in range(x.size):
        inputs = offset(0)
        row = d
        weights = offset(0)
        for i in range(x.size):
            work[i] = 1.0 if i == j else 0.0
        for layer in range(1, len(widths)):
            n = offset(widths[layer - 1])
            m = offset(widths[layer])
            tangents = row + m
            for k in range(m):
                work[tangents + k] = 0.0
            add_products(parameters, weights, n, m, work, inputs, tangents)
            for k in range(m):
                work[tangents + k] *= work[row + k]
            weights += n * m + m
            inputs = tangents
            row = tangents + m
        for i in range(x.size):
            work[row + offset(i)] = 0.0
        add_products(parameters, weights, offset(widths[len(widths) - 1]), d, work, inputs, row)
        for i in range(x.size):
            jac[i, j] = work[row + offset(i)]
    return 0
