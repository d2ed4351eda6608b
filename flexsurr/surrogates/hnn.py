"""Hamiltonian neural network (loss: eq. 11): a network H(q, p), and Hamilton's equations of it."""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.surrogates.activations import slope
from flexsurr.surrogates.layers import offset
from flexsurr.surrogates.scalar_networks import ScalarNetworks, gradient_of_scalar
from flexsurr.surrogates.scaled_kernel import scaled_kernel
from flexsurr.surrogates.scaling import FeatureScaling
from flexsurr.surrogates.surrogate import symplectic


@dataclass(frozen=True, eq=False)
class HNN(ScalarNetworks):
    """q̇ = ∂H/∂p, ṗ = −∂H/∂q with H = Σ c σ(… σ(W₁ x + b₁) …): eq. 2 without load or dissipation.

    The scaled field is Hamiltonian; that in the units of the states is so if the scaling is canonical.
    """

    architecture: ClassVar[str] = "hnn"

    def scaled_field(self, x: Array) -> Array:
        """Hamilton's equations of Ĥ."""
        return symplectic(self.scaled_gradient(x, 0))

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
    networks: int = 1


@implements_rhs(HNNKernel, inline=False)
def _hnn(kernel, t, x, dx, work):
    gradient_of_scalar(kernel.activation, kernel.widths, kernel.parameters, offset(0), x, work)
    r = x.size // 2
    for j in range(r):
        dx[j] = work[r + j]
        dx[r + j] = -work[j]
