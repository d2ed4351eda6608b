"""Dissipative Hamiltonian neural network (loss: eq. 12): a Hamiltonian and a dissipation function."""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from flexsurr.simulation.rhs import Array, implements_rhs
from flexsurr.surrogates.layers import offset
from flexsurr.surrogates.scalar_networks import ScalarNetworks, gradient_of_scalar
from flexsurr.surrogates.scaled_kernel import scaled_kernel
from flexsurr.surrogates.surrogate import symplectic


@dataclass(frozen=True, eq=False)
class DissipativeHNN(ScalarNetworks):
    """q̇ = ∂H/∂p + ∂D/∂q, ṗ = −∂H/∂q + ∂D/∂p (in eq. 12), with H and D two separate networks (Fig. 7).

    With r ≥ 2 not every field has this form; and H need not be the energy: adding a holomorphic function of
    q + ip to D − iH leaves the field as it is.
    """

    architecture: ClassVar[str] = "dissipative_hnn"
    networks: ClassVar[int] = 2

    def scaled_field(self, x: Array) -> Array:
        """Hamilton's equations of Ĥ, and the gradient of D̂."""
        return symplectic(self.scaled_gradient(x, 0)) + self.scaled_gradient(x, 1)

    def scaled_kernel(self, parameters: Array) -> "DissipativeHNNKernel":
        """The scaled field with these weights, for compiled code."""
        return DissipativeHNNKernel(self.sigma.tag, self.widths, parameters)

    def kernel(self) -> tuple[NamedTuple, int]:
        """Layer by layer, one network after the other; the scales are applied to inputs and outputs."""
        size = self.widths[0] + 2 * sum(self.hidden)
        return scaled_kernel(self.scaled_kernel(self.parameters.copy()), size, self.scaling, self.widths[0])


class DissipativeHNNKernel(NamedTuple):
    """Any number of states and hidden layers; widths and parameters as in `Network`."""

    activation: NamedTuple
    widths: tuple[int, ...]
    parameters: Array
    networks: int = DissipativeHNN.networks


@implements_rhs(DissipativeHNNKernel, inline=False)
def _dissipative_hnn(kernel, t, x, dx, work):
    activation, widths, parameters, networks = kernel
    r = x.size // 2
    gradient_of_scalar(activation, widths, parameters, offset(0), x, work)
    for j in range(r):
        dx[j] = work[r + j]
        dx[r + j] = -work[j]
    gradient_of_scalar(activation, widths, parameters, offset(parameters.size // networks), x, work)
    for j in range(x.size):
        dx[j] += work[j]
