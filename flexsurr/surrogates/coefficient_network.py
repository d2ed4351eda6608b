"""A network from features to coefficients: one hidden layer, inputs and outputs scaled to ±1.

What the study puts in place of its vortex lattice (25 features, 75 neurons, 12 coefficients). Unlike the
other surrogates it is no right-hand side but a part of one.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from flexsurr.simulation.mapping import CompiledMapping, implements_mapping
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.activations import ACTIVATIONS, value
from flexsurr.surrogates.archive import read_archive, write_archive

FORMAT = "flexsurr coefficient network 1"
ARRAYS = ("parameters", "input_low", "input_high", "output_low", "output_high")


def shapes_of(inputs: int, hidden: int, outputs: int) -> list[tuple[int, ...]]:
    """Shapes of the hidden weights and biases, then of the output's, as they follow in `parameters`."""
    return [(inputs, hidden), (hidden,), (hidden, outputs), (outputs,)]


@dataclass(frozen=True, eq=False)
class CoefficientNetwork:
    """Coefficients (..., k) of features (..., n), in plain NumPy; `compiled` gives the fast form.

    The intervals `input_low` to `input_high` (n,) and `output_low` to `output_high` (k,), in the units of
    features and coefficients, are what the network sees as −1 to 1. `parameters` holds hidden weights
    (n, hidden) and biases (hidden,), then the output's (hidden, k) and (k,). Raises ValueError for arrays
    that don't fit.
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

    def __post_init__(self) -> None:
        if self.activation not in ACTIVATIONS:
            raise ValueError(f"activation {self.activation!r} is not one of {', '.join(ACTIVATIONS)}")
        n, k = len(self.input_names), len(self.output_names)
        if self.hidden < 1 or self.parameters.shape != (sum(map(math.prod, shapes_of(n, self.hidden, k))),):
            raise ValueError(
                f"{self.parameters.shape} parameters don't make {n} x {self.hidden} x {k} neurons"
            )
        for low, high, count in (
            (self.input_low, self.input_high, n),
            (self.output_low, self.output_high, k),
        ):
            if low.shape != (count,) or high.shape != (count,) or not np.all(low < high):
                raise ValueError("each input and each output has an interval, and low < high")

    def arrays(self) -> list[Array]:
        """Views of the parameters in their shapes."""
        shapes = shapes_of(len(self.input_names), self.hidden, len(self.output_names))
        pieces = np.split(self.parameters, np.cumsum([math.prod(shape) for shape in shapes[:-1]]))
        return [piece.reshape(shape) for piece, shape in zip(pieces, shapes, strict=True)]

    @cached_property
    def _folded(self) -> tuple[Array, Array, Array, Array, Array]:
        """Origin of the features, then weights and biases with the scales in them."""
        weights, biases, weights_out, biases_out = self.arrays()
        half = 0.5 * (self.input_high - self.input_low)
        output_half = 0.5 * (self.output_high - self.output_low)
        return (
            # subtracted before it meets a weight, so that large features cost no digits
            0.5 * (self.input_low + self.input_high),
            weights / half[:, None],
            biases.copy(),
            weights_out * output_half,
            0.5 * (self.output_low + self.output_high) + output_half * biases_out,
        )

    def __call__(self, u: Array) -> Array:
        """Coefficients (..., k) at features `u` (..., n)."""
        origin, weights, biases, weights_out, biases_out = self._folded
        hidden = ACTIVATIONS[self.activation].value((u - origin) @ weights + biases)
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
        )
        return CompiledMapping(kernel, self.hidden, self.input_names, self.output_names)


class CoefficientNetworkKernel(NamedTuple):
    """origin (n,), weights (n, hidden), biases (hidden,), weights_out (k, hidden), biases_out (k,)."""

    activation: NamedTuple
    origin: Array
    weights: Array
    biases: Array
    weights_out: Array
    biases_out: Array


@implements_mapping(CoefficientNetworkKernel)
def _coefficient_network(kernel, u, y, work):
    activation, origin, weights, biases, weights_out, biases_out = kernel
    # unsigned: numba lets a signed index be negative, and a loop over such does not vectorise
    hidden = np.uint64(biases.size)
    for k in range(hidden):
        work[k] = biases[k]
    for j in range(np.uint64(origin.size)):
        x = u[j] - origin[j]
        for k in range(hidden):
            work[k] += x * weights[j, k]
    for k in range(hidden):
        work[k] = value(activation, work[k])
    for i in range(np.uint64(biases_out.size)):
        total = biases_out[i]
        for k in range(hidden):
            total += work[k] * weights_out[i, k]
        y[i] = total


def save_coefficient_network(network: CoefficientNetwork, path: str | Path) -> None:
    """Write `network` to `path` (.npz) whole: beside its place first, then moved there."""
    header = {
        "hidden": network.hidden,
        "activation": network.activation,
        "input_names": network.input_names,
        "output_names": network.output_names,
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
    )
