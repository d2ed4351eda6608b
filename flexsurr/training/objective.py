"""The training loss of a network as a function of its weights, with its derivatives."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import Network
from flexsurr.surrogates.scaling import scaled_rates, scaled_states
from flexsurr.training.backpropagation import workspace
from flexsurr.training.batches import fields, loss_and_gradient, residuals_and_jacobian
from flexsurr.training.levenberg_marquardt import Equations, accumulated, second_difference
from flexsurr.training.losses import output_weights
from flexsurr.training.one_hidden_layer import OneHiddenLayer

Minimised = Literal["nmse", "mean_square", "norms"]

CHUNK = 1 << 20  # elements of the Jacobian that exist at a time: 8 MB


@dataclass(frozen=True, eq=False)
class Objective:
    """The nmse of `network`, with any weights, at scaled states `x` and scaled derivatives `y` (m, 2r).

    First-order steps may minimise another loss: see `batches.loss_and_gradient`. Sums over all samples of a
    network with one hidden layer are those of `OneHiddenLayer`; others take a Jacobian, in pieces.
    """

    network: Network
    x: Array
    y: Array
    minimised: Minimised = "nmse"

    @classmethod
    def of(cls, network: Network, x: Array, dx: Array) -> "Objective":
        """The objective for states `x` and derivatives `dx` (m, 2r), both in their units."""
        return cls(network, scaled_states(network.scaling, x), scaled_rates(network.scaling, dx))

    @cached_property
    def output_weights(self) -> Array:
        """Weights (2r,) of the outputs' mean squared errors, in the precision of the samples."""
        return output_weights(self.y).astype(self.y.dtype)

    @cached_property
    def step_weights(self) -> Array:
        """Those of the loss that is `minimised`: equal ones for the mean of squares, none for norms."""
        if self.minimised == "nmse":
            return self.output_weights
        count = self.y.shape[1]
        return np.full(count, 1.0 / count if self.minimised == "mean_square" else 0.0, dtype=self.y.dtype)

    @cached_property
    def _shallow(self) -> OneHiddenLayer | None:
        """The same where there is one hidden layer."""
        if len(self.network.hidden) > 1:
            return None
        return OneHiddenLayer.of_field(self.network, self.x, self.y, self.output_weights)

    @cached_property
    def everything(self) -> NDArray[np.int64]:
        """The indices of all samples."""
        return np.arange(len(self.x))

    @cached_property
    def workspace(self) -> Array:
        """Scratch for one sample, in the precision of the samples."""
        return workspace(self.network.widths, self.network.networks).astype(self.x.dtype)

    def kernel(self, parameters: Array) -> NamedTuple:
        """The network with these weights, for compiled code; the array is shared, not copied."""
        return self.network.scaled_kernel(parameters)

    def loss(self, parameters: Array) -> float:
        """The nmse over all samples; not finite where a weight or the field is not."""
        if self._shallow is not None:
            return self._shallow.loss(parameters)
        error = self._fields(parameters) - self.y
        return float(np.einsum("si,si,i->", error, error, self.output_weights) / len(error))

    def _fields(self, parameters: Array) -> Array:
        """The scaled field (m, 2r) at all samples."""
        found: Array = fields(self.kernel(parameters), self.x, self.workspace)
        return found

    def gradient(self, parameters: Array, gradient: Array, samples: NDArray[np.int64] | None = None) -> float:
        """What is `minimised`, over all `samples` (indices; by default all), its gradient into `gradient`."""
        if self._shallow is not None and samples is None and self.minimised == "nmse":
            return self._shallow.gradient(parameters, gradient)
        chosen = self.everything if samples is None else samples
        loss: float = loss_and_gradient(
            self.kernel(parameters), self.x, self.y, self.step_weights, chosen, gradient, self.workspace
        )
        return loss

    def bend(self, parameters: Array, step: Array) -> Array:
        """Jᵀr″ (n,), of the second derivative r″ of the residuals along `step` (n,)."""
        if self._shallow is not None:
            return self._shallow.bend(parameters, step)
        here = self._fields(parameters)
        second = second_difference(here, self._fields, parameters, step)
        gradient = np.empty_like(parameters)
        # its residuals are r″
        loss_and_gradient(
            self.kernel(parameters),
            self.x,
            here - second,
            self.output_weights,
            self.everything,
            gradient,
            self.workspace,
        )
        return 0.5 * gradient

    def normal_equations(self, parameters: Array) -> Equations:
        """JᵀJ and Jᵀr, accumulated over pieces of the Jacobian: memory is bounded by `CHUNK`."""
        if self._shallow is not None:
            return self._shallow.normal_equations(parameters)
        kernel = self.kernel(parameters)
        roots = np.sqrt(self.output_weights / len(self.x))

        def rows(part: slice, residuals: Array, jacobian: Array) -> None:
            residuals_and_jacobian(
                kernel, self.x[part], self.y[part], roots, residuals, jacobian, self.workspace
            )

        return accumulated(rows, self.x.shape, parameters.size, CHUNK)
