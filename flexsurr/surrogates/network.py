"""Fully connected networks: their widths, their activation and where each weight lies in the vector."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.activations import ActivationFunction, activation_function
from flexsurr.surrogates.layers import Shapes, layer_shapes, size_of, views
from flexsurr.surrogates.surrogate import Surrogate


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
