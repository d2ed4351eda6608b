"""Networks whose field is made of gradients: scalars read out of one last hidden layer."""

from dataclasses import dataclass
from typing import ClassVar

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.network import Network


@dataclass(frozen=True, eq=False)
class ScalarHeads(Network):
    """`heads` scalars Σ c σ(… σ(W₁ x + b₁) …), each with a readout c of its own and no constant.

    A constant would not move the field. For one hidden layer the gradients need σ′ only.
    """

    heads: ClassVar[int]

    @classmethod
    def readout_shapes(cls, states: int, neurons: int) -> list[tuple[int, ...]]:
        """A vector c for each scalar."""
        return [(neurons,)] * cls.heads

    def _hidden_layers(self, x: Array) -> tuple[Array, list[Array]]:
        """Arguments of the last layer's σ, and the slopes σ′ of the layers before it."""
        layers = self.arrays()[: -self.heads]
        slopes: list[Array] = []
        z = x @ layers[0] + layers[1]
        for weights, biases in zip(layers[2::2], layers[3::2], strict=True):
            slopes.append(self.sigma.slope(z))
            z = self.sigma.value(z) @ weights + biases
        return z, slopes

    def scaled_scalar(self, x: Array, head: int) -> Array:
        """Scalar number `head` of scaled states, (..., 2r) -> (...)."""
        z, _ = self._hidden_layers(x)
        return self.sigma.value(z) @ self.arrays()[head - self.heads]

    def scaled_gradients(self, x: Array) -> list[Array]:
        """Gradient of each scalar at scaled states, (..., 2r) -> (..., 2r), by a sweep back."""
        arrays = self.arrays()
        layers, readouts = arrays[: -self.heads], arrays[-self.heads :]
        z, slopes = self._hidden_layers(x)
        slope = self.sigma.slope(z)
        gradients = []
        for readout in readouts:
            gradient = (slope * readout) @ layers[-2].T
            for weights, slopes_before in zip(layers[-4::-2], reversed(slopes), strict=True):
                gradient = (gradient * slopes_before) @ weights.T
            gradients.append(gradient)
        return gradients
