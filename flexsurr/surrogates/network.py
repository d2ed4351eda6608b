"""Fully connected networks: their widths, their activation and where each weight lies in the vector."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.activations import ACTIVATIONS, ActivationFunction
from flexsurr.surrogates.surrogate import Surrogate


@dataclass(frozen=True, eq=False)
class Network(Surrogate):
    """A network with one or more hidden layers of the given widths.

    The vector of parameters holds, layer by layer, the weights (from, to) and the biases (to,); then
    what reads the last layer out. Inputs come first so that a loop over neurons runs through
    neighbouring numbers.
    """

    hidden: tuple[int, ...]
    activation: str

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

    @property
    def shapes(self) -> tuple[tuple[int, ...], ...]:
        """Shapes of the arrays in `parameters`, in their order."""
        layers = zip(self.widths, self.hidden, strict=False)
        return tuple(shape for n, m in layers for shape in ((n, m), (m,))) + self.readout_shapes

    @property
    def readout_shapes(self) -> tuple[tuple[int, ...], ...]:
        """Shapes of the arrays that read the last hidden layer out."""
        raise NotImplementedError

    @property
    def parameter_count(self) -> int:
        """Weights and biases of all layers."""
        return sum(int(np.prod(shape)) for shape in self.shapes)

    @property
    def sigma(self) -> ActivationFunction:
        """The activation function."""
        return ACTIVATIONS[self.activation]

    def arrays(self) -> list[Array]:
        """Views of the parameters in their shapes."""
        ends = np.cumsum([int(np.prod(shape)) for shape in self.shapes])
        pieces = np.split(self.parameters, ends[:-1])
        return [piece.reshape(shape) for piece, shape in zip(pieces, self.shapes, strict=True)]

    def settings(self) -> dict[str, Any]:
        """Hidden layers and activation."""
        return {"hidden": list(self.hidden), "activation": self.activation}
