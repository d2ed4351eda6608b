"""What a port-Hamiltonian network is trained on: inverse dynamics first, then the error of its field."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.storage import Scales
from flexsurr.surrogates import NetworkPortHamiltonian
from flexsurr.surrogates.packed import symmetric
from flexsurr.training.inverse_dynamics import channel_spread
from flexsurr.training.losses import output_weights
from flexsurr.training.normal_equations import NormalEquations, accumulated
from flexsurr.training.port_hamiltonian_rows import residuals_and_jacobian

CHUNK = 1 << 20  # elements of the Jacobian that exist at a time: 8 MB


@dataclass(frozen=True, eq=False)
class PortHamiltonianObjective:
    """A mean squared error of `network`, with any parameters, over samples of scaled `x` and `y` (m, 2r).

    forward: the nmse of the field. Otherwise: that of inverse dynamics, of p and of ṗ at the measured rates.
    `roots` (2r,) are the roots of the weights of the squared errors, by their number 2r and m.
    """

    network: NetworkPortHamiltonian
    x: Array
    y: Array
    roots: Array
    forward: bool

    @classmethod
    def of(
        cls, network: NetworkPortHamiltonian, x: Array, dx: Array, forward: bool
    ) -> "PortHamiltonianObjective":
        """The objective for states `x` and derivatives `dx` (m, 2r), both in their units."""
        count = x.shape[1]
        y = dx / network.scaling.rates(count)
        if forward:
            weights = output_weights(y)
        else:
            weights = 1.0 / (count * channel_spread(network.scaling, Scales.of(x, dx)) ** 2)
        return cls(network, x / network.scaling.states(count), y, np.sqrt(weights / len(x)), forward)

    @cached_property
    def _floor(self) -> Array:
        return symmetric(self.network.floor, self.network.pairs)

    def _rows(self, parameters: Array, part: slice, residuals: Array, jacobian: Array) -> None:
        x, y = self.x[part], self.y[part]
        residuals_and_jacobian(
            self.network.sigma.tag, self.network.even, self.network.hidden[0], parameters, self._floor,
            x, y, self.roots, self.forward, residuals[: x.size], jacobian[: x.size],
        )  # fmt: skip

    def loss(self, parameters: Array) -> float:
        """The weighted mean squared error over all samples."""
        residuals = np.empty(self.x.size)
        self._rows(parameters, slice(None), residuals, np.empty((0, parameters.size)))
        return float(residuals @ residuals)

    def normal_equations(self, parameters: Array) -> NormalEquations:
        """JᵀJ and Jᵀr, accumulated over pieces of the Jacobian."""
        return accumulated(
            lambda part, residuals, jacobian: self._rows(parameters, part, residuals, jacobian),
            self.x.shape,
            parameters.size,
            CHUNK,
        )
