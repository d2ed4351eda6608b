"""Dense networks: where their weights lie in one vector, in NumPy, and compiled code for layers.

In compiled code everything passed between layers lies in one workspace; layers are offsets into it and into
the weights. Offsets and counters are unsigned: numba lets a signed index be negative, and a loop in which
it cannot rule that out does not vectorise. One array instead of a tuple or slices, because taking a
reference to an array costs as much as a layer.
"""

import itertools
import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT, Array
from flexsurr.surrogates.activations import ActivationFunction, activation_function
from flexsurr.surrogates.surrogate import Surrogate

Shapes = list[tuple[int, ...]]


def layer_shapes(widths: Sequence[int]) -> Shapes:
    """Weights (from, to) and biases (to,) of each layer between these `widths`, the inputs' first.

    Inputs come first so that a loop over neurons runs through neighbouring numbers.
    """
    return [shape for n, m in itertools.pairwise(widths) for shape in ((n, m), (m,))]


def size_of(shapes: Shapes) -> int:
    """How many numbers arrays of these shapes hold."""
    return sum(map(math.prod, shapes))


def views(parameters: Array, shapes: Shapes) -> list[Array]:
    """Views of the vector `parameters`, which holds arrays of these shapes one after the other."""
    pieces = np.split(parameters, np.cumsum([math.prod(shape) for shape in shapes[:-1]]))
    return [piece.reshape(shape) for piece, shape in zip(pieces, shapes, strict=True)]


class Dense(NamedTuple):
    """y = σ(… σ(x W₁ + b₁) …) V + c: hidden layers of one activation, then a linear readout.

    `hidden` holds W₁ (n, m₁), b₁ (m₁,), W₂, b₂ and so on, `readout` V (m, k) and `constants` c (k,).
    """

    sigma: ActivationFunction
    hidden: Sequence[Array]
    readout: Array
    constants: Array | float = 0.0

    def _arguments(self, x: Array) -> list[Array]:
        """What σ is taken of in each hidden layer."""
        arguments = [x @ self.hidden[0] + self.hidden[1]]
        for weights, biases in zip(self.hidden[2::2], self.hidden[3::2], strict=True):
            arguments.append(self.sigma.value(arguments[-1]) @ weights + biases)
        return arguments

    def __call__(self, x: Array) -> Array:
        """The outputs, (..., n) -> (..., k)."""
        y: Array = self.sigma.value(self._arguments(x)[-1]) @ self.readout + self.constants
        return y

    def jacobian(self, x: Array) -> Array:
        """∂(outputs)/∂(inputs), (..., n) -> (..., k, n), by a sweep back."""
        jacobian = self.readout.T
        for weights, z in zip(self.hidden[-2::-2], reversed(self._arguments(x)), strict=True):
            scaled = jacobian * self.sigma.slope(z)[..., None, :]
            # as one product, not one for each of the inputs
            jacobian = (scaled.reshape(-1, len(weights.T)) @ weights.T).reshape(*scaled.shape[:-1], -1)
        return jacobian


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def forward(parameters, layer, n, m, work, inputs, z):
    """z_k = b_k + Σ_j a_j W_jk for the layer of n inputs and m neurons at the offset `layer`."""
    biases = layer + n * m
    for k in range(m):
        work[z + k] = parameters[biases + k]
    add_products(parameters, layer, n, m, work, inputs, z)


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def add_products(parameters, layer, n, m, work, inputs, z):
    """Add Σ_j a_j W_jk to z_k: all that a layer does to tangents."""
    for j in range(n):
        a = work[inputs + j]
        row = layer + j * m
        for k in range(m):
            work[z + k] += a * parameters[row + k]


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def back(parameters, layer, n, m, work, z, inputs):
    """a_j = Σ_k W_jk z_k, the transpose of `forward` without biases."""
    for j in range(n):
        total = 0.0
        row = layer + j * m
        for k in range(m):
            total += parameters[row + k] * work[z + k]
        work[inputs + j] = total


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def read(weights, row, work, first, count):
    """Σ_k V_k a_k, an output of a readout: `count` weights from `row` on, and values from `first` on."""
    total = 0.0
    for k in range(count):
        total += weights[row + k] * work[first + k]
    return total


@njit(error_model="numpy")
def offset(number):
    """`number` as an offset."""
    return np.uint64(number)


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def write_products(x, first, r, work, products):
    """The packed products x_i x_j, j ≤ i, of the r numbers of x from `first` on."""
    e = products
    for i in range(r):
        for j in range(i + offset(1)):
            work[e] = x[first + i] * x[first + j]
            e += offset(1)


@dataclass(frozen=True, eq=False)
class Network(Surrogate):
    """One network, or several of the same shape, with one or more hidden layers of the given widths.

    The vector of parameters holds, network by network and layer by layer, the weights (from, to) and the
    biases (to,); then what reads the last layer out.
    """

    hidden: tuple[int, ...]
    activation: str

    networks: ClassVar[int] = 1

    def __post_init__(self) -> None:
        if not self.hidden or min(self.hidden) < 1:
            raise ValueError(
                f"a network takes one or more hidden layers of one or more neurons, not {self.hidden}"
            )
        activation_function(self.activation)  # refuses what is none
        super().__post_init__()

    @property
    def widths(self) -> tuple[int, ...]:
        """Number of states, then the neurons of each hidden layer."""
        return (len(self.state_names), *self.hidden)

    @classmethod
    def shapes(cls, states: int, hidden: tuple[int, ...]) -> Shapes:
        """Shapes of the arrays in `parameters`, in their order."""
        return (layer_shapes((states, *hidden)) + cls.readout_shapes(states, hidden[-1])) * cls.networks

    @classmethod
    @abstractmethod
    def readout_shapes(cls, states: int, neurons: int) -> Shapes:
        """Shapes of the arrays that read a last hidden layer of `neurons` out."""

    @abstractmethod
    def scaled_kernel(self, parameters: Array) -> NamedTuple:
        """The scaled field with these weights in place of its own, for compiled code; the array is shared."""

    @property
    def parameter_count(self) -> int:
        """Weights and biases of all layers."""
        return size_of(self.shapes(len(self.state_names), self.hidden))

    @property
    def sigma(self) -> ActivationFunction:
        """The activation function."""
        return activation_function(self.activation)

    def arrays(self) -> list[Array]:
        """Views of the parameters in their shapes."""
        return views(self.parameters, self.shapes(len(self.state_names), self.hidden))

    def network_arrays(self, number: int) -> list[Array]:
        """Those of one of the networks."""
        arrays = self.arrays()
        count = len(arrays) // self.networks
        return arrays[number * count : (number + 1) * count]

    def settings(self) -> dict[str, Any]:
        """Hidden layers and activation."""
        return {"hidden": list(self.hidden), "activation": self.activation}
