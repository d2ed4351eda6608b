"""The same networks and maps as torch modules: what the study's own are, before export to compiled code."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import Network, NetworkMap
from flexsurr.surrogates.hnn import ScalarNetworks
from flexsurr.surrogates.layers import views
from flexsurr.surrogates.scaling import rates_of, scaled_states
from flexsurr.surrogates.surrogate import FormOfSurrogate
from flexsurr.surrogates.torch_module import field

ACTIVATIONS: dict[str, Callable[[Tensor], Tensor]] = {
    "elu": nn.functional.elu,
    "tanh": torch.tanh,
    # torch's own softplus is cut off at 20
    "softplus": lambda z: torch.logaddexp(z, torch.zeros_like(z)),
    "silu": nn.functional.silu,
    "squareplus": lambda z: 0.5 * (z + torch.sqrt(z * z + 4.0)),
    "half_log": lambda z: 0.5 * torch.log1p(z * z),
    "cube": lambda z: z * z * z / 3.0,
    "atan": torch.atan,
}


class Dense(nn.Module):
    """Hidden layers, and a linear readout of the last one."""

    def __init__(self, widths: tuple[int, ...], outputs: int, bias: bool, activation: str) -> None:
        super().__init__()
        self.hidden = nn.ModuleList(nn.Linear(n, m) for n, m in itertools.pairwise(widths))
        self.readout = nn.Linear(widths[-1], outputs, bias=bias)
        self.sigma = ACTIVATIONS[activation]

    def forward(self, x: Tensor) -> Tensor:
        """The outputs, (..., inputs) -> (..., outputs)."""
        for layer in self.hidden:
            x = self.sigma(layer(x))
        output: Tensor = self.readout(x)
        return output


class TorchNetwork(nn.Module):
    """A network of scaled states, as `flexsurr.surrogates.torch_module` takes them.

    No scalars: rates, an MLP. One: H, an HNN. Two: H and the dissipation function D, a D-HNN.
    """

    def __init__(self, widths: tuple[int, ...], activation: str, scalars: int) -> None:
        super().__init__()
        outputs = 1 if scalars else widths[0]
        self.networks = nn.ModuleList(
            Dense(widths, outputs, not scalars, activation) for _ in range(max(scalars, 1))
        )

    def forward(self, x: Tensor) -> Tensor | tuple[Tensor, ...]:
        """Rates (batch, 2r), or scalars (batch, 1), at scaled states (batch, 2r)."""
        first, *others = (network(x) for network in self.networks)
        return (first, *others) if others else first


def order_in_torch(network: Network) -> NDArray[np.int64]:
    """Where each of a module's weights lies in the vector of `network`: torch has weights (to, from)."""
    places = np.arange(float(network.parameter_count))
    arrays = views(places, network.shapes(len(network.state_names), network.hidden))
    return np.concatenate([each.T.ravel() for each in arrays]).astype(np.int64)


def to_torch(network: Network, dtype: torch.dtype = torch.float64) -> TorchNetwork:
    """The torch module with the weights of `network`."""
    scalars = network.networks if isinstance(network, ScalarNetworks) else 0
    module = TorchNetwork(network.widths, network.activation, scalars).to(dtype)
    weights = torch.from_numpy(network.parameters[order_in_torch(network)]).to(dtype)
    nn.utils.vector_to_parameters(weights, module.parameters())
    return module


def from_torch(module: TorchNetwork, network: Network) -> Network:
    """`network` with the weights of the torch `module` of its shape in place of its own."""
    parameters = np.empty(network.parameter_count)
    weights = nn.utils.parameters_to_vector(module.parameters()).detach()
    parameters[order_in_torch(network)] = weights.double().cpu().numpy()
    return replace(network, parameters=parameters)


@dataclass(frozen=True, eq=False)
class TorchModel(FormOfSurrogate):
    """A Model that evaluates its network through torch, differentiating H at every call."""

    module: TorchNetwork

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (..., 2r) at states `x` (..., 2r), in the units of the states per second."""
        scaling = self.surrogate.scaling
        scaled = torch.from_numpy(scaled_states(scaling, x)).to(next(self.module.parameters()).dtype)
        rates = field(self.module, torch.atleast_2d(scaled)).detach().double().numpy()
        return rates_of(scaling, rates.reshape(x.shape))


def torch_model(surrogate: Network, dtype: torch.dtype = torch.float64) -> TorchModel:
    """`surrogate` as the study's networks run: by torch, with autograd at every right-hand side."""
    return TorchModel(surrogate, to_torch(surrogate, dtype).eval())


class TorchMap:
    """A network map as its training leaves it: a torch module in double precision, called with arrays."""

    def __init__(self, learned: NetworkMap) -> None:
        weights, *_, biases_out = layers = learned.layers()
        self.module = Dense(weights.shape[:2], biases_out.size, True, learned.activation).double().eval()
        with torch.no_grad():
            for parameter, array in zip(self.module.parameters(), layers, strict=True):
                parameter.copy_(torch.from_numpy(array.T.copy()))
        self._products = torch.tensor(learned.products, dtype=torch.int64).reshape(-1, 2).T
        self._origin, self._half, self._output_origin, self._output_half = (
            torch.from_numpy(array)
            for intervals in (learned.inputs, learned.outputs)
            for array in (intervals.origin, intervals.half)
        )

    @torch.no_grad()
    def __call__(self, u: Array) -> Array:
        """Outputs (..., k) at inputs `u` (..., n), both in their units."""
        x = (torch.from_numpy(u) - self._origin) / self._half
        if self._products.numel():
            first, second = self._products
            x = torch.cat([x, x[..., first] * x[..., second]], dim=-1)
        return np.asarray((self._output_origin + self._output_half * self.module(x)).numpy())


def export_error(learned: NetworkMap, count: int = 1000, seed: int = 0) -> float:
    """Largest difference of the compiled map from torch's, over each output's interval.

    At `count` random inputs within the limits of training: what the export costs in accuracy.
    """
    inputs, outputs = learned.inputs, learned.outputs
    unit = np.random.default_rng(seed).uniform(size=(count, len(inputs.names)))
    u = inputs.low + (inputs.high - inputs.low) * unit
    difference = np.abs(learned.compiled()(u) - TorchMap(learned)(u))
    return float((difference / (outputs.high - outputs.low)).max())
