"""Hamiltonian neural network (loss: eq. 11): a network H(q, p), and Hamilton's equations of it."""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.surrogates.activations import slope, value
from flexsurr.surrogates.layers import back, forward, offset
from flexsurr.surrogates.scalar_heads import ScalarHeads
from flexsurr.surrogates.scaled_kernel import scaled_kernel
from flexsurr.surrogates.scaling import FeatureScaling
from flexsurr.surrogates.surrogate import symplectic


@dataclass(frozen=True, eq=False)
class HNN(ScalarHeads):
    """q̇ = ∂H/∂p, ṗ = −∂H/∂q with H = Σ c σ(… σ(W₁ x + b₁) …): eq. 2 without load or dissipation.

    The scaled field is Hamiltonian; that in the units of the states is so if the scaling is canonical.
    """

    architecture: ClassVar[str] = "hnn"
    heads: ClassVar[int] = 1

    def scaled_energy(self, x: Array) -> Array:
        """Ĥ of scaled states, (..., 2r) -> (...)."""
        return self.scaled_scalar(x, 0)

    def scaled_field(self, x: Array) -> Array:
        """Hamilton's equations of Ĥ."""
        return symplectic(*self.scaled_gradients(x))

    def energy(self, x: Array) -> Array:
        """H(x) − H(0), (..., 2r) -> (...), in the product of the units of q and p per second."""
        states = self.scaling.states(len(self.state_names))
        difference = self.scaled_energy(x / states) - self.scaled_energy(np.zeros_like(states))
        return self.scaling.energy * difference

    def scaled_kernel(self, parameters: Array) -> "HNNKernel":
        """The scaled field with these weights, for compiled code."""
        return HNNKernel(self.sigma.tag, self.widths, parameters)

    def kernel(self) -> tuple[NamedTuple, int]:
        """A single loop for one hidden layer over one pair (q, p), else layer by layer."""
        work_size = self.widths[0] + 2 * sum(self.hidden)
        if isinstance(self.scaling, FeatureScaling):
            unscaled = self.scaled_kernel(self.parameters.copy())
            return scaled_kernel(unscaled, work_size, self.scaling, self.widths[0])
        states = self.scaling.states(len(self.state_names))
        inner, *others, readout = self.arrays()
        inner = inner / states[:, None]
        readout = readout * self.scaling.energy
        if self.widths == (2, self.hidden[0]):
            return PhasePlaneHNN(
                self.sigma.tag, inner[0].copy(), inner[1].copy(), others[0].copy(), readout
            ), 0
        parameters = np.concatenate([array.ravel() for array in (inner, *others, readout)])
        return self.scaled_kernel(parameters), work_size


class PhasePlaneHNN(NamedTuple):
    """One hidden layer over a single pair (q, p): weights of q and of p, biases, readout, each (n,)."""

    activation: NamedTuple
    w_q: Array
    w_p: Array
    bias: Array
    readout: Array


@implements_rhs(PhasePlaneHNN)
def _phase_plane_hnn(kernel, t, x, dx, work):
    activation, w_q, w_p, bias, readout = kernel
    q, p = x[0], x[1]
    dh_dq = 0.0
    dh_dp = 0.0
    for k in range(bias.size):
        g = readout[k] * slope(activation, w_q[k] * q + w_p[k] * p + bias[k])
        dh_dq += g * w_q[k]
        dh_dp += g * w_p[k]
    dx[0] = dh_dp
    dx[1] = -dh_dq


class HNNKernel(NamedTuple):
    """Any number of states and hidden layers; widths and parameters as in `Network`."""

    activation: NamedTuple
    widths: tuple[int, ...]
    parameters: Array


@implements_rhs(HNNKernel, inline=False)
def _hnn(kernel, t, x, dx, work):
    activation, widths, parameters = kernel
    last = len(widths) - 1
    # work: the inputs, then for each layer the arguments and the values of σ
    for j in range(x.size):
        work[j] = x[j]
    values = offset(0)
    weights = offset(0)
    for layer in range(1, last + 1):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        z = values + n
        forward(parameters, weights, n, m, work, values, z)
        values = z + m
        weights += n * m + m
        if layer < last:
            for k in range(m):
                work[values + k] = value(activation, work[z + k])
    m = offset(widths[last])
    for k in range(m):
        work[values + k] = parameters[weights + k]
    # back: the derivatives of H by each layer's values, then by its arguments, in their places
    for layer in range(last, 0, -1):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        z = values - m
        for k in range(m):
            work[z + k] = work[values + k] * slope(activation, work[z + k])
        values = z - n
        weights -= n * m + m
        back(parameters, weights, n, m, work, z, values)
    r = x.size // 2
    for j in range(r):
        dx[j] = work[r + j]
        dx[r + j] = -work[j]
