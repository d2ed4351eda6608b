"""Networks whose field is made of gradients: scalars, each with hidden layers of its own."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT, Array
from flexsurr.surrogates.activations import slope, value
from flexsurr.surrogates.layers import back, forward, offset
from flexsurr.surrogates.network import Network
from flexsurr.surrogates.scaling import scaled_states


@dataclass(frozen=True, eq=False)
class ScalarNetworks(Network):
    """As many scalars Σ c σ(… σ(W₁ x + b₁) …) as `networks`, of equal widths, without a constant.

    A constant would not move the field. The first scalar is the Hamiltonian. For one hidden layer the
    gradients need σ′ only.
    """

    @classmethod
    def readout_shapes(cls, states: int, neurons: int) -> list[tuple[int, ...]]:
        """A vector c."""
        return [(neurons,)]

    def _hidden_layers(self, x: Array, layers: list[Array]) -> tuple[Array, list[Array]]:
        """Arguments of the last layer's σ, and the slopes σ′ of the layers before it."""
        slopes: list[Array] = []
        z = x @ layers[0] + layers[1]
        for weights, biases in zip(layers[2::2], layers[3::2], strict=True):
            slopes.append(self.sigma.slope(z))
            z = self.sigma.value(z) @ weights + biases
        return z, slopes

    def scaled_scalar(self, x: Array, number: int) -> Array:
        """Scalar `number` of scaled states, (..., 2r) -> (...)."""
        *layers, readout = self.network_arrays(number)
        z, _ = self._hidden_layers(x, layers)
        return self.sigma.value(z) @ readout

    def scaled_gradient(self, x: Array, number: int) -> Array:
        """Gradient of scalar `number` at scaled states, (..., 2r) -> (..., 2r), by a sweep back."""
        *layers, readout = self.network_arrays(number)
        z, slopes = self._hidden_layers(x, layers)
        gradient = (self.sigma.slope(z) * readout) @ layers[-2].T
        for weights, slopes_before in zip(layers[-4::-2], reversed(slopes), strict=True):
            gradient = (gradient * slopes_before) @ weights.T
        return gradient

    def energy(self, x: Array) -> Array:
        """H(x) − H(0), (..., 2r) -> (...), in the product of the units of q and p per second.

        Where the scaling is not canonical, the states' equations are not Hamilton's of this energy.
        """
        origin = np.zeros(len(self.state_names))
        scaled, scaled_origin = scaled_states(self.scaling, x), scaled_states(self.scaling, origin)
        return self.scaling.energy * (self.scaled_scalar(scaled, 0) - self.scaled_scalar(scaled_origin, 0))


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def gradient_of_scalar(activation, widths, parameters, weights, x, work):
    """The gradient by `x` of the scalar network whose parameters begin at `weights`, left at `work`'s start.

    The workspace holds the inputs, then for each layer the arguments and the values of σ.
    """
    last = len(widths) - 1
    for j in range(x.size):
        work[j] = x[j]
    values = offset(0)
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
    # back: the derivatives of the scalar by each layer's values, then by its arguments, in their places
    for layer in range(last, 0, -1):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        z = values - m
        for k in range(m):
            work[z + k] = work[values + k] * slope(activation, work[z + k])
        values = z - n
        weights -= n * m + m
        back(parameters, weights, n, m, work, z, values)
