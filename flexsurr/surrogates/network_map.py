"""Learned maps as networks of one hidden layer, in NumPy and compiled.

Networks of the same inputs side by side are one network, whose outputs read neurons of their own alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.simulation.mapping import CompiledMapping, implements_mapping, implements_mapping_jacobian
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.activations import ActivationFunction, activation_function, slope, value
from flexsurr.surrogates.layers import Dense, Shapes, forward, layer_shapes, offset, read, size_of, views
from flexsurr.surrogates.learned_map import Intervals
from flexsurr.surrogates.packed import OPTIONS

Pairs = tuple[tuple[int, int], ...]


def with_products(x: Array, products: Pairs) -> Array:
    """Scaled inputs `x` (..., n) and, after them, the product of each of the P pairs: (..., n + P)."""
    if not products:
        return x
    first, second = np.array(products).T
    return np.concatenate([x, x[..., first] * x[..., second]], axis=-1)


@dataclass(frozen=True, eq=False)
class NetworkMap:
    """One hidden layer: W₂ᵀ σ(W₁ᵀ x + b₁) + b₂ is the scaled outputs, x the scaled inputs.

    Products of pairs of inputs may be further inputs. `parameters` holds W₁ (n + P, hidden), b₁ (hidden,),
    W₂ (hidden, k) and b₂ (k,). Raises ValueError for arrays that don't fit.
    """

    inputs: Intervals
    outputs: Intervals
    hidden: int
    activation: str
    parameters: Array
    products: Pairs = ()

    kind: ClassVar[str] = "network"

    def __post_init__(self) -> None:
        activation_function(self.activation)  # refuses what is none
        if self.hidden < 1 or self.parameters.shape != (size_of(self._shapes),):
            raise ValueError(
                f"{self.parameters.shape} parameters don't make {len(self.inputs.names)} x {self.hidden} x"
                f" {len(self.outputs.names)} neurons"
            )

    @property
    def output_names(self) -> tuple[str, ...]:
        """Names of the outputs, in their order."""
        return self.outputs.names

    @property
    def sigma(self) -> ActivationFunction:
        """The activation function."""
        return activation_function(self.activation)

    @property
    def _shapes(self) -> Shapes:
        inputs = len(self.inputs.names) + len(self.products)
        return layer_shapes((inputs, self.hidden, len(self.outputs.names)))

    def layers(self) -> list[Array]:
        """Views W₁, b₁, W₂, b₂ of the parameters."""
        return views(self.parameters, self._shapes)

    @cached_property
    def dense(self) -> Dense:
        """Of u − origin and its products: with all scales in it but for that origin.

        It is subtracted before it meets a weight, so that large inputs cost no digits.
        """
        weights, biases, weights_out, biases_out = self.layers()
        halves = with_products(self.inputs.half, self.products)
        return Dense(
            self.sigma,
            (weights / halves[:, None], biases.copy()),
            weights_out * self.outputs.half,
            self.outputs.origin + self.outputs.half * biases_out,
        )

    def __call__(self, u: Array) -> Array:
        """Outputs at inputs, (..., n) -> (..., k)."""
        return self.dense(with_products(u - self.inputs.origin, self.products))

    def jacobian(self, u: Array) -> Array:
        """∂(outputs)/∂(inputs), (..., n) -> (..., k, n)."""
        by_all = self.dense.jacobian(with_products(u - self.inputs.origin, self.products))
        n = len(self.inputs.names)
        jacobian: Array = by_all[..., :n].copy()
        x = (u - self.inputs.origin)[..., None, :]
        for place, (first, second) in enumerate(self.products, start=n):
            jacobian[..., first] += by_all[..., place] * x[..., second]
            jacobian[..., second] += by_all[..., place] * x[..., first]
        return jacobian

    @property
    def form(self) -> str:
        """Its neurons and their activation."""
        return f"{self.hidden} {self.activation}"

    @property
    def parameter_count(self) -> int:
        """Weights and biases of both layers."""
        return self.parameters.size

    def compiled(self) -> CompiledMapping:
        """A layer, and a row of the readout for each output."""
        sigma, (weights, biases), readout, constants = self.dense
        kernel = NetworkMapKernel(
            sigma.tag,
            self.inputs.origin,
            np.concatenate([weights.ravel(), biases]),
            readout.T.ravel(),
            np.asarray(constants),
            np.array(self.products, dtype=np.int64).reshape(-1, 2),
            _read_neurons(readout),
        )
        # inputs and neurons, and one output's share of them in the Jacobian
        return CompiledMapping(kernel, len(weights) + 2 * self.hidden, self.inputs.names, self.outputs.names)

    def settings(self) -> dict[str, Any]:
        """Neurons, activation and products."""
        return {"hidden": self.hidden, "activation": self.activation, "products": self.products}

    def arrays(self) -> dict[str, np.ndarray]:
        """Weights, and the outputs' intervals."""
        return {
            "parameters": self.parameters,
            "output_low": self.outputs.low,
            "output_high": self.outputs.high,
        }


def side_by_side(networks: Sequence[NetworkMap], output_names: tuple[str, ...]) -> NetworkMap:
    """Networks of the same inputs and activation as one network with the outputs of all, in this order."""
    hidden, outputs = sum(network.hidden for network in networks), len(output_names)
    weights_out, vectors = np.zeros((hidden, outputs)), np.empty((3, outputs))
    row = 0
    for network in networks:
        _, _, readout, biases_out = network.layers()
        columns = [output_names.index(name) for name in network.output_names]
        weights_out[row : row + network.hidden, columns] = readout
        vectors[:, columns] = biases_out, network.outputs.low, network.outputs.high
        row += network.hidden
    inner = np.hstack([network.layers()[0] for network in networks])
    biases = np.concatenate([network.layers()[1] for network in networks])
    return replace(
        networks[0],
        outputs=Intervals(output_names, vectors[1], vectors[2]),
        hidden=hidden,
        parameters=np.concatenate([inner.ravel(), biases, weights_out.ravel(), vectors[0]]),
    )


def _read_neurons(weights_out: Array) -> NDArray[np.int64]:
    """The first neuron that each output reads and the one after the last, (k, 2)."""
    reads = np.zeros((weights_out.shape[1], 2), dtype=np.int64)
    for output, column in enumerate(weights_out.T):
        if (neurons := np.flatnonzero(column)).size:
            reads[output] = neurons[0], neurons[-1] + 1
    return reads


class NetworkMapKernel(NamedTuple):
    """Origin (n,), weights (n + P, hidden) and biases in one `layer`, `readout` (k · hidden,), `constants`.

    `products` (P, 2) are pairs of inputs; output i reads the neurons from `reads`[i, 0] to before [i, 1].
    """

    activation: NamedTuple
    origin: Array
    layer: Array
    readout: Array
    constants: Array
    products: NDArray[np.int64]
    reads: NDArray[np.int64]


@njit(forceinline=True, **OPTIONS)
def _write_arguments(kernel, u, n, inputs, hidden, work):
    """The inputs from their origin, their products, and the arguments of the neurons."""
    origin, products = kernel.origin, kernel.products
    for j in range(n):
        work[j] = u[j] - origin[j]
    for m in range(offset(products.shape[0])):
        work[n + m] = work[products[m, 0]] * work[products[m, 1]]
    forward(kernel.layer, offset(0), inputs, hidden, work, offset(0), inputs)


@implements_mapping(NetworkMapKernel)
def _network_map(kernel, u, y, work):
    activation, origin, _, readout, constants, products, reads = kernel
    # work: the inputs and their products, then the neurons
    n = offset(origin.size)
    inputs = n + offset(products.shape[0])
    hidden = offset(readout.size // constants.size)
    _write_arguments(kernel, u, n, inputs, hidden, work)
    for k in range(hidden):
        work[inputs + k] = value(activation, work[inputs + k])
    for i in range(offset(constants.size)):
        first = offset(reads[i, 0])
        count = offset(reads[i, 1]) - first
        y[i] = constants[i] + read(readout, i * hidden + first, work, inputs + first, count)


@implements_mapping_jacobian(NetworkMapKernel)
def _jacobian_of_network_map(kernel, u, jac, work):
    activation, origin, layer, readout, constants, products, reads = kernel
    # work: the inputs and their products, slopes of the neurons, those times an output's weights
    n = offset(origin.size)
    inputs = n + offset(products.shape[0])
    hidden = offset(readout.size // constants.size)
    weighted = inputs + hidden
    _write_arguments(kernel, u, n, inputs, hidden, work)
    for k in range(hidden):
        work[inputs + k] = slope(activation, work[inputs + k])
    for i in range(offset(constants.size)):
        first = offset(reads[i, 0])
        count = offset(reads[i, 1]) - first
        for k in range(count):
            work[weighted + k] = readout[i * hidden + first + k] * work[inputs + first + k]
        for j in range(n):
            jac[i * n + j] = read(layer, j * hidden + first, work, weighted, count)
        for m in range(offset(products.shape[0])):
            by_product = read(layer, (n + m) * hidden + first, work, weighted, count)
            one = offset(products[m, 0])
            other = offset(products[m, 1])
            jac[i * n + one] += by_product * work[other]
            jac[i * n + other] += by_product * work[one]
