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
from flexsurr.surrogates.scalar_heads import ScalarHeads

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


class TorchNetwork(nn.Module):
    """A network of scaled states: its outputs, or the field made of the gradients of `scalars` of them.

    No scalars: an MLP. One: H, an HNN. Two: H and the dissipation function, a D-HNN.
    """

    def __init__(self, widths: tuple[int, ...], activation: str, scalars: int, dtype: torch.dtype) -> None:
        super().__init__()
        pairs = itertools.pairwise(widths)
        self.hidden = nn.ModuleList(nn.Linear(n, m, dtype=dtype) for n, m in pairs)
        outputs = scalars or widths[0]
        self.readout = nn.Linear(widths[-1], outputs, bias=not scalars, dtype=dtype)
        self.sigma = ACTIVATIONS[activation]
        self.scalars = scalars

    def output(self, x: Tensor) -> Tensor:
        """The scalars (..., 1 or 2) or the field (..., 2r)."""
        for layer in self.hidden:
            x = self.sigma(layer(x))
        output: Tensor = self.readout(x)
        return output

    def forward(self, x: Tensor) -> Tensor:
        """The scaled field, (..., 2r) -> (..., 2r)."""
        if not self.scalars:
            return self.output(x)
        with torch.enable_grad():
            x = x if x.requires_grad else x.detach().requires_grad_()
            hamiltonian, *dissipation = self.output(x).unbind(dim=-1)
            by_q, by_p = self._gradient(hamiltonian, x).chunk(2, dim=-1)
            field = torch.cat([by_p, -by_q], dim=-1)
            return field + self._gradient(dissipation[0], x) if dissipation else field

    def _gradient(self, scalar: Tensor, x: Tensor) -> Tensor:
        (gradient,) = torch.autograd.grad(scalar.sum(), x, create_graph=self.training, retain_graph=True)
        return gradient


def to_torch(network: Network, dtype: torch.dtype = torch.float64) -> TorchNetwork:
    """The torch module with the weights of `network`."""
    scalars = network.heads if isinstance(network, ScalarHeads) else 0
    module = TorchNetwork(network.widths, network.activation, scalars, dtype)
    with torch.no_grad():
        for parameter, array in zip(module.parameters(), _as_torch(network, network.arrays()), strict=True):
            parameter.copy_(torch.from_numpy(array.copy()))
    return module


def _as_torch(network: Network, arrays: list[Array]) -> list[Array]:
    """The network's arrays as torch has them: weights (to, from), the readouts of all scalars in one."""
    scalars = network.heads if isinstance(network, ScalarHeads) else 0
    hidden, readouts = arrays[: len(arrays) - scalars], arrays[len(arrays) - scalars :]
    return [array.T for array in hidden] + ([np.array(readouts)] if scalars else [])


def from_torch(module: TorchNetwork, network: Network) -> Network:
    """`network` with the weights of the torch `module` of its shape in place of its own."""
    arrays = [parameter.detach().double().numpy() for parameter in module.parameters()]
    if module.scalars:
        *arrays, readouts = arrays
        arrays += list(readouts)
    return replace(network, parameters=np.concatenate([np.ascontiguousarray(a.T).ravel() for a in arrays]))


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
        scaling, count = self.surrogate.scaling, len(self.state_names)
        scaled = torch.from_numpy(x / scaling.states(count)).to(self.module.readout.weight.dtype)
        field = self.module(scaled).detach().double().numpy()
        rates: Array = scaling.rates(count) * field
        return rates


def torch_model(surrogate: Network, dtype: torch.dtype = torch.float64) -> TorchModel:
    """`surrogate` as the study's networks run: by torch, with autograd at every right-hand side."""
    return TorchModel(surrogate, to_torch(surrogate, dtype).eval())
