"""Dissipative Hamiltonian neural network (loss: eq. 12): a Hamiltonian and a dissipation function."""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.surrogates.activations import slope, value
from flexsurr.surrogates.layers import back, forward, offset
from flexsurr.surrogates.scalar_heads import ScalarHeads
from flexsurr.surrogates.scaled_kernel import scaled_kernel
from flexsurr.surrogates.surrogate import symplectic


@dataclass(frozen=True, eq=False)
class DissipativeHNN(ScalarHeads):
    """q̇ = ∂H/∂p + ∂D/∂q, ṗ = −∂H/∂q + ∂D/∂p (in eq. 12), with H and D two readouts of one network.

    Two separate networks are the special case in which each neuron is read by one of the two. With r ≥ 2
    not every field has this form; and H need not be the energy: adding a holomorphic function of q + ip to
    D − iH leaves the field as it is.
    """

    architecture: ClassVar[str] = "dissipative_hnn"
    heads: ClassVar[int] = 2

    def scaled_field(self, x: Array) -> Array:
        """Hamilton's equations of Ĥ, and the gradient of D̂."""
        hamiltonian, dissipation = self.scaled_gradients(x)
        return symplectic(hamiltonian) + dissipation

    def energy(self, x: Array) -> Array:
        """H(x) − H(0), (..., 2r) -> (...), in the units of an energy; see above for what it may lack."""
        states = self.scaling.states(len(self.state_names))
        difference = self.scaled_scalar(x / states, 0) - self.scaled_scalar(0.0 * states, 0)
        return self.scaling.energy * difference

    def scaled_kernel(self, parameters: Array) -> "DissipativeHNNKernel":
        """The scaled field with these weights, for compiled code."""
        return DissipativeHNNKernel(self.sigma.tag, self.widths, parameters)

    def kernel(self) -> tuple[NamedTuple, int]:
        """Layer by layer; the scales are applied to inputs and outputs."""
        size = self.widths[0] + 2 * sum(self.hidden) + 2 * max(self.widths)
        return scaled_kernel(self.scaled_kernel(self.parameters.copy()), size, self.scaling, self.widths[0])


class DissipativeHNNKernel(NamedTuple):
    """Any number of states and hidden layers; widths and parameters as in `Network`."""

    activation: NamedTuple
    widths: tuple[int, ...]
    parameters: Array


@implements_rhs(DissipativeHNNKernel, inline=False)
def _dissipative_hnn(kernel, t, x, dx, work):
    activation, widths, parameters = kernel
    last = len(widths) - 1
    # work: the inputs, for each layer the slopes and the values of σ, two vectors of the widest layer
    for j in range(x.size):
        work[j] = x[j]
    values = offset(0)
    weights = offset(0)
    widest = offset(widths[0])
    for layer in range(1, last + 1):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        widest = max(widest, m)
        z = values + n
        forward(parameters, weights, n, m, work, values, z)
        values = z + m
        weights += n * m + m
        if layer < last:
            for k in range(m):
                work[values + k] = value(activation, work[z + k])
        for k in range(m):
            work[z + k] = slope(activation, work[z + k])
    adjoint = values + offset(widths[last])
    arguments = adjoint + widest
    r = x.size // 2
    for head in range(2):
        m = offset(widths[last])
        readout = weights + offset(head) * m
        for k in range(m):
            work[adjoint + k] = parameters[readout + k]
        at = values
        layer_weights = weights
        for layer in range(last, 0, -1):
            n = offset(widths[layer - 1])
            m = offset(widths[layer])
            z = at - m
            for k in range(m):
                work[arguments + k] = work[adjoint + k] * work[z + k]
            at = z - n
            layer_weights -= n * m + m
            back(parameters, layer_weights, n, m, work, arguments, adjoint)
        if head == 0:
            for j in range(r):
                dx[j] = work[adjoint + r + j]
                dx[r + j] = -work[adjoint + j]
        else:
            for j in range(r):
                dx[j] += work[adjoint + j]
                dx[r + j] += work[adjoint + r + j]
