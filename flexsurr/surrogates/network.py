"""Fully connected networks: their widths, their activation and where each weight lies in the vector."""

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.activations import ACTIVATIONS, ActivationFunction
from flexsurr.surrogates.surrogate import Surrogate


@dataclass(frozen=True, eq=False)
class Network(Surrogate):
    """One network, or several of the same shape, with one or more hidden layers of the given widths.

    The vector of parameters holds, network by network and layer by layer, the weights (from, to) and the
    biases (to,); then what reads the last layer out. Inputs come first so that a loop over neurons runs
    through neighbouring numbers.
    """

    hidden: tuple[int, ...]
    activation: str

    networks: ClassVar[int] = 1

    def __post_init__(self) -> None:
        if not self.hidden or min(self.hidden) < 1:
            raise ValueError(
                f"a network takes one or more hidden layers of one or more neurons, not {self.hidden}"
            )
        if self.activation not in ACTIVATIONS:
            raise ValueError(f"activation {self.activation!r} is not one of {', '.join(ACTIVATIONS)}")
        super().__post_init__()

    @property
    def widths(self) -> tuple[int, ...]:
        """Number of states, then the neurons of each hidden layer."""
        return (len(self.state_names), *self.hidden)

    @classmethod
    def shapes(cls, states: int, hidden: tuple[int, ...]) -> list[tuple[int, ...]]:
        """Shapes of the arrays in `parameters`, in their order."""
        layers = zip((states, *hidden), hidden, strict=False)
        network = [shape for n, m in layers for shape in ((n, m), (m,))]
        return (network + cls.readout_shapes(states, hidden[-1])) * cls.networks

    @classmethod
    @abstractmethod
    def readout_shapes(cls, states: int, neurons: int) -> list[tuple[int, ...]]:
        """Shapes of the arrays that read a last hidden layer of `neurons` out."""

    @abstractmethod
    def scaled_kernel(self, parameters: Array) -> NamedTuple:
        """The scaled field with these weights in place of its own, for compiled code; the array is shared."""

    @property
    def parameter_count(self) -> int:
        """Weights and biases of all layers."""
        return sum(map(math.prod, self.shapes(len(self.state_names), self.hidden)))

    @property
    def sigma(self) -> ActivationFunction:
        """The activation function."""
        return ACTIVATIONS[self.activation]

    def arrays(self) -> list[Array]:
        """Views of the parameters in their shapes."""
        shapes = self.shapes(len(self.state_names), self.hidden)
        pieces = np.split(self.parameters, np.cumsum([math.prod(shape) for shape in shapes[:-1]]))
        return [piece.reshape(shape) for piece, shape in zip(pieces, shapes, strict=True)]

    def network_arrays(self, number: int) -> list[Array]:
        """Those of one of the networks."""
        arrays = self.arrays()
        count = len(arrays) // self.networks
        return arrays[number * count : (number + 1) * count]

    def settings(self) -> dict[str, Any]:
        """Hidden layers and activation."""
        return {"hidden": list(self.hidden), "activation": self.activation}
