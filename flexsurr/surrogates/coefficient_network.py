"""A network from features to coefficients: one hidden layer, inputs and outputs scaled to ±1.

What the study puts in place of its vortex lattice (25 features, 75 neurons, 12 coefficients). Unlike the
other surrogates it is no right-hand side but a part of one. Products of features may be further inputs, and
networks of the same features side by side are one network, whose outputs read neurons of their own alone.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.mapping import CompiledMapping, implements_mapping
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.activations import ACTIVATIONS, value
from flexsurr.surrogates.archive import read_archive, write_archive

FORMAT = "flexsurr coefficient network 2"
ARRAYS = ("parameters", "input_low", "input_high", "output_low", "output_high")


Pairs = tuple[tuple[int, int], ...]


def with_products(x: Array, products: Pairs) -> Array:
    """Scaled features `x` (..., n) and, after them, the product of each of the P pairs: (..., n + P)."""
    if not products:
        return x
    first, second = np.array(products).T
    return np.concatenate([x, x[..., first] * x[..., second]], axis=-1)


def shapes_of(inputs: int, hidden: int, outputs: int) -> list[tuple[int, ...]]:
    """Shapes of the hidden weights and biases, then of the output's, as they follow in `parameters`."""
    return [(inputs, hidden), (hidden,), (hidden, outputs), (outputs,)]


@dataclass(frozen=True, eq=False)
class CoefficientNetwork:
    """Coefficients (..., k) of features (..., n), in plain NumPy; `compiled` gives the fast form.

    The intervals `input_low` to `input_high` (n,) and `output_low` to `output_high` (k,), in the units of
    features and coefficients, are what the network sees as −1 to 1. `parameters` holds hidden weights
    (n + P, hidden) and biases (hidden,), then the output's (hidden, k) and (k,); the P `products` are pairs
    of features. Raises ValueError for arrays that don't fit.
    """

    parameters: Array
    hidden: int
    activation: str
    input_low: Array
    input_high: Array
    output_low: Array
    output_high: Array
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]
    products: Pairs = ()

    def __post_init__(self) -> None:
        if self.activation not in ACTIVATIONS:
            raise ValueError(f"activation {self.activation!r} is not one of {', '.join(ACTIVATIONS)}")
        n, k = len(self.input_names), len(self.output_names)
        if self.hidden < 1 or self.parameters.shape != (sum(map(math.prod, self._shapes)),):
            raise ValueError(
                f"{self.parameters.shape} parameters don't make {n} x {self.hidden} x {k} neurons"
            )
        for low, high, count in (
            (self.input_low, self.input_high, n),
            (self.output_low, self.output_high, k),
        ):
            if low.shape != (count,) or high.shape != (count,) or not np.all(low < high):
                raise ValueError("each input and each output has an interval, and low < high")

    @property
    def _shapes(self) -> list[tuple[int, ...]]:
        return shapes_of(len(self.input_names) + len(self.products), self.hidden, len(self.output_names))

    def arrays(self) -> list[Array]:
        """Views of the parameters in their shapes."""
        shapes = self._shapes
        pieces = np.split(self.parameters, np.cumsum([math.prod(shape) for shape in shapes[:-1]]))
        return [piece.reshape(shape) for piece, shape in zip(pieces, shapes, strict=True)]

    @cached_property
    def _folded(self) -> tuple[Array, Array, Array, Array, Array]:
        """Origin of the features, then weights and biases with the scales in them."""
        weights, biases, weights_out, biases_out = self.arrays()
        half = 0.5 * (self.input_high - self.input_low)
        halves = with_products(half, self.products)
        output_half = 0.5 * (self.output_high - self.output_low)
        return (
            # subtracted before it meets a weight, so that large features cost no digits
            0.5 * (self.input_low + self.input_high),
            weights / halves[:, None],
            biases.copy(),
            weights_out * output_half,
            0.5 * (self.output_low + self.output_high) + output_half * biases_out,
        )

    def __call__(self, u: Array) -> Array:
        """Coefficients (..., k) at features `u` (..., n)."""
        origin, weights, biases, weights_out, biases_out = self._folded
        hidden = ACTIVATIONS[self.activation].value(
            with_products(u - origin, self.products) @ weights + biases
        )
        return hidden @ weights_out + biases_out

    def compiled(self) -> CompiledMapping:
        """The same function as compiled code."""
        origin, weights, biases, weights_out, biases_out = self._folded
        kernel = CoefficientNetworkKernel(
            ACTIVATIONS[self.activation].tag,
            origin,
            weights,
            biases,
            np.ascontiguousarray(weights_out.T),
            biases_out,
            np.array(self.products, dtype=np.int64).reshape(-1, 2),
            _read_neurons(weights_out),
        )
        return CompiledMapping(kernel, self.hidden, self.input_names, self.output_names)


def side_by_side(networks: Sequence[CoefficientNetwork], output_names: tuple[str, ...]) -> CoefficientNetwork:
    """Networks of the same features and activation as one network with the outputs of all, in this order."""
    first = networks[0]
    hidden = sum(network.hidden for network in networks)
    places = [[output_names.index(name) for name in network.output_names] for network in networks]
    weights_out, vectors = np.zeros((hidden, len(output_names))), np.empty((3, len(output_names)))
    row = 0
    for network, columns in zip(networks, places, strict=True):
        _, _, readout, biases_out = network.arrays()
        weights_out[row : row + network.hidden, columns] = readout
        vectors[:, columns] = biases_out, network.output_low, network.output_high
        row += network.hidden
    inner = np.hstack([network.arrays()[0] for network in networks])
    biases = np.concatenate([network.arrays()[1] for network in networks])
    return replace(
        first,
        parameters=np.concatenate([inner.ravel(), biases, weights_out.ravel(), vectors[0]]),
        hidden=hidden,
        output_low=vectors[1],
        output_high=vectors[2],
        output_names=output_names,
    )


def _read_neurons(weights_out: Array) -> NDArray[np.int64]:
    """The first neuron that each output reads and the one after the last, (k, 2)."""
    reads = np.zeros((weights_out.shape[1], 2), dtype=np.int64)
    for output, column in enumerate(weights_out.T):
        if (neurons := np.flatnonzero(column)).size:
            reads[output] = neurons[0], neurons[-1] + 1
    return reads


class CoefficientNetworkKernel(NamedTuple):
    """origin (n,), weights (n + P, hidden), biases (hidden,), weights_out (k, hidden), biases_out (k,).

    `products` (P, 2) are pairs of features; output i reads the neurons from `reads`[i, 0] to before [i, 1].
    """

    activation: NamedTuple
    origin: Array
    weights: Array
    biases: Array
    weights_out: Array
    biases_out: Array
    products: NDArray[np.int64]
    reads: NDArray[np.int64]


@implements_mapping(CoefficientNetworkKernel)
def _coefficient_network(kernel, u, y, work):
    activation, origin, weights, biases, weights_out, biases_out, products, reads = kernel
    # unsigned: numba lets a signed index be negative, and a loop over such does not vectorise
    hidden = np.uint64(biases.size)
    for k in range(hidden):
        work[k] = biases[k]
    for j in range(np.uint64(origin.size)):
        x = u[j] - origin[j]
        for k in range(hidden):
            work[k] += x * weights[j, k]
    for m in range(np.uint64(products.shape[0])):
        a, b = products[m, 0], products[m, 1]
        x = (u[a] - origin[a]) * (u[b] - origin[b])
        row = np.uint64(origin.size) + m
        for k in range(hidden):
            work[k] += x * weights[row, k]
    for k in range(hidden):
        work[k] = value(activation, work[k])
    for i in range(np.uint64(biases_out.size)):
        total = biases_out[i]
        for k in range(np.uint64(reads[i, 0]), np.uint64(reads[i, 1])):
            total += work[k] * weights_out[i, k]
        y[i] = total


def save_coefficient_network(network: CoefficientNetwork, path: str | Path) -> None:
    """Write `network` to `path` (.npz) whole: beside its place first, then moved there."""
    header = {
        "hidden": network.hidden,
        "activation": network.activation,
        "input_names": network.input_names,
        "output_names": network.output_names,
        "products": network.products,
    }
    write_archive(path, FORMAT, header, {name: getattr(network, name) for name in ARRAYS})


def load_coefficient_network(path: str | Path) -> CoefficientNetwork:
    """The network in `path`. Raises SurrogateFileError for a damaged or foreign file, OSError for none."""
    return read_archive(path, FORMAT, "a coefficient network", _network)


def _network(header: dict[str, Any], arrays: dict[str, Array]) -> CoefficientNetwork:
    return CoefficientNetwork(
        **{name: arrays[name] for name in ARRAYS},
        hidden=header["hidden"],
        activation=header["activation"],
        input_names=tuple(header["input_names"]),
        output_names=tuple(header["output_names"]),
        products=tuple((first, second) for first, second in header["products"]),
    )
