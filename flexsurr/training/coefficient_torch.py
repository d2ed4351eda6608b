"""A network of coefficients as a torch module: what it is before its export to compiled code."""

import numpy as np
import torch
from torch import Tensor, nn

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.coefficient_network import CoefficientNetwork
from flexsurr.training.networks import ACTIVATIONS


class CoefficientModule(nn.Module):
    """Coefficients (..., k) of features (..., n), in their units, by torch in double precision."""

    def __init__(self, network: CoefficientNetwork) -> None:
        super().__init__()
        weights, biases, weights_out, biases_out = (torch.from_numpy(a.copy()) for a in network.arrays())
        inputs, neurons = weights.shape
        self.hidden = nn.Linear(inputs, neurons, dtype=torch.float64)
        self.readout = nn.Linear(neurons, len(network.output_names), dtype=torch.float64)
        with torch.no_grad():
            self.hidden.weight.copy_(weights.T)
            self.hidden.bias.copy_(biases)
            self.readout.weight.copy_(weights_out.T)
            self.readout.bias.copy_(biases_out)
        self.sigma = ACTIVATIONS[network.activation]
        self.products = torch.tensor(network.products, dtype=torch.int64).reshape(-1, 2).T
        intervals = (network.input_low, network.input_high, network.output_low, network.output_high)
        low, high, output_low, output_high = (torch.from_numpy(ends.copy()) for ends in intervals)
        self.origin, self.scale = 0.5 * (low + high), 0.5 * (high - low)
        self.output_origin = 0.5 * (output_low + output_high)
        self.output_scale = 0.5 * (output_high - output_low)

    def forward(self, u: Tensor) -> Tensor:
        """The coefficients."""
        x = (u - self.origin) / self.scale
        if self.products.numel():
            first, second = self.products
            x = torch.cat([x, x[..., first] * x[..., second]], dim=-1)
        y: Tensor = self.readout(self.sigma(self.hidden(x)))
        return self.output_origin + self.output_scale * y


class TorchCoefficients:
    """The same as a function of arrays, as a simulation calls it."""

    def __init__(self, network: CoefficientNetwork) -> None:
        self.module = CoefficientModule(network).eval()

    @torch.no_grad()
    def __call__(self, u: Array) -> Array:
        """Coefficients (..., k) at features `u` (..., n)."""
        return np.asarray(self.module(torch.from_numpy(u)).numpy())


def export_error(network: CoefficientNetwork, count: int = 1000, seed: int = 0) -> float:
    """Largest difference of the compiled network from torch's, over each output's interval.

    At `count` random features within the limits of training: what the export costs in accuracy.
    """
    unit = np.random.default_rng(seed).uniform(size=(count, len(network.input_names)))
    u = network.input_low + (network.input_high - network.input_low) * unit
    difference = np.abs(network.compiled()(u) - TorchCoefficients(network)(u))
    return float((difference / (network.output_high - network.output_low)).max())
