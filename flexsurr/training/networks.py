"""The same networks as torch modules: what the study's own networks are, and run through autograd."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import torch
from torch import Tensor, nn

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import Network
from flexsurr.surrogates.scalar_networks import ScalarNetworks
from flexsurr.surrogates.scaling import rates_of, scaled_states

ACTIVATIONS: dict[str, Callable[[Tensor], Tensor]] = {
    "elu": nn.functional.elu,
    "tanh": torch.tanh,
    # torch's own softplus is cut off at 20
    "softplus": lambda z: torch.logaddexp(z, torch.zeros_like(z)),
    "silu": nn.functional.silu,
    "squareplus": lambda z: 0.5 * (z + torch.sqrt(z * z + 4.0)),
    "half_log": lambda z: 0.5 * torch.log1p(z * z),
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
    """A network of scaled states: its outputs, or the field made of the gradients of `scalars` networks.

    No scalars: an MLP. One: H, an HNN. Two: H and the dissipation function, a D-HNN.
    """

    def __init__(self, widths: tuple[int, ...], activation: str, scalars: int) -> None:
        super().__init__()
        outputs = 1 if scalars else widths[0]
        self.networks = nn.ModuleList(
            Dense(widths, outputs, not scalars, activation) for _ in range(max(scalars, 1))
        )
        self.scalars = scalars

    def forward(self, x: Tensor) -> Tensor:
        """The scaled field, (..., 2r) -> (..., 2r)."""
        if not self.scalars:
            field: Tensor = self.networks[0](x)
            return field
        with torch.enable_grad():
            x = x if x.requires_grad else x.detach().requires_grad_()
            hamiltonian, *dissipation = (self._gradient(network(x), x) for network in self.networks)
            by_q, by_p = hamiltonian.chunk(2, dim=-1)
            field = torch.cat([by_p, -by_q], dim=-1)
            return field + dissipation[0] if dissipation else field

    def _gradient(self, scalar: Tensor, x: Tensor) -> Tensor:
        (gradient,) = torch.autograd.grad(scalar.sum(), x, create_graph=self.training, retain_graph=True)
        return gradient


def to_torch(network: Network, dtype: torch.dtype = torch.float64) -> TorchNetwork:
    """The torch module with the weights of `network`; torch has weights (to, from)."""
    scalars = network.networks if isinstance(network, ScalarNetworks) else 0
    module = TorchNetwork(network.widths, network.activation, scalars).to(dtype)
    with torch.no_grad():
        for parameter, array in zip(module.parameters(), network.arrays(), strict=True):
            parameter.copy_(torch.from_numpy(array.T.reshape(parameter.shape).copy()))
    return module


def from_torch(module: TorchNetwork, network: Network) -> Network:
    """`network` with the weights of the torch `module` of its shape in place of its own."""
    arrays = [parameter.detach().double().numpy().T for parameter in module.parameters()]
    return replace(network, parameters=np.concatenate([np.ascontiguousarray(a).ravel() for a in arrays]))


@dataclass(frozen=True, eq=False)
class TorchModel:
    """A Model that evaluates its network through torch, differentiating H at every call."""

    surrogate: Network
    module: TorchNetwork
    breakpoints: ClassVar[tuple[float, ...]] = ()

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the states, those of the surrogate."""
        return self.surrogate.state_names

    @property
    def state_units(self) -> tuple[str, ...]:
        """Units of the states, those of the surrogate."""
        return self.surrogate.state_units

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (..., 2r) at states `x` (..., 2r), in the units of the states per second."""
        scaling = self.surrogate.scaling
        scaled = torch.from_numpy(scaled_states(scaling, x)).to(next(self.module.parameters()).dtype)
        return rates_of(scaling, self.module(scaled).detach().double().numpy())


def torch_model(surrogate: Network, dtype: torch.dtype = torch.float64) -> TorchModel:
    """`surrogate` as the study's networks run: by torch, with autograd at every right-hand side."""
    return TorchModel(surrogate, to_torch(surrogate, dtype).eval())
