"""The training loss of any torch module as a function of its weights, by autograd, on any device."""

import os

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from flexsurr.config.errors import ConfigurationError
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.torch_module import field, weights_of
from flexsurr.training.losses import output_weights
from flexsurr.training.objective import Minimised

PIECE = 16384  # samples of which a whole loss is made at a time


def device_of(name: str) -> torch.device:
    """The device `name`: cpu, cuda, or auto, which is cuda where there is one.

    Raises ConfigurationError for cuda on a machine without.
    """
    there = torch.cuda.is_available()
    if name == "cuda" and not there:
        raise ConfigurationError(["device: cuda is not available on this machine; allowed: cpu, auto"])
    if name == "cpu" or not there:
        return torch.device("cpu")
    # the same sums in the same order each time
    os.environ.setdefault("CUBLAS_WORKSPACE_CONFIG", ":4096:8")
    torch.use_deterministic_algorithms(True)
    return torch.device("cuda")


class TorchObjective:
    """The nmse of the field of `module` at scaled states `x` and scaled derivatives `y` (m, 2r).

    First-order steps may minimise another loss: see `batches.loss_and_gradient`. Samples are held in the
    precision and on the device of the module. The weights that a loss is asked for stay in the module.
    """

    def __init__(self, module: nn.Module, x: Array, y: Array, minimised: Minimised = "nmse") -> None:
        self.module, self.minimised = module, minimised
        self.weights = weights_of(module)
        like = self.weights[0]
        self.x, self.y, self._of_outputs = (
            torch.from_numpy(np.ascontiguousarray(a)).to(like) for a in (x, y, output_weights(y))
        )

    @property
    def parameters(self) -> Array:
        """The weights of the module, one after the other."""
        with torch.no_grad():
            return nn.utils.parameters_to_vector(self.weights).cpu().double().numpy()

    @parameters.setter
    def parameters(self, parameters: Array) -> None:
        with torch.no_grad():
            vector = torch.from_numpy(parameters).to(self.weights[0])
            nn.utils.vector_to_parameters(vector.clone(), self.weights)

    def loss(self, parameters: Array) -> float:
        """The nmse over all samples; not finite where a weight or the field is not."""
        self.parameters = parameters
        self.module.eval()
        total = sum(
            ((field(self.module, x) - y).detach().double() ** 2).sum(dim=0) @ self._of_outputs.double()
            for x, y in zip(self.x.split(PIECE), self.y.split(PIECE), strict=True)
        )
        return float(total / len(self.x))

    def gradient(self, parameters: Array, gradient: Array, samples: NDArray[np.int64] | None = None) -> float:
        """What is `minimised`, over all `samples` (indices; by default all), its gradient into `gradient`."""
        self.parameters = parameters
        self.module.eval()
        chosen = torch.arange(len(self.x)) if samples is None else torch.from_numpy(samples)
        total, gradient[:] = 0.0, 0.0
        for piece in chosen.split(PIECE):
            loss, gradients = self.of_batch(piece)
            share = len(piece) / len(chosen)
            total += share * loss.item()
            gradient += share * torch.cat([g.reshape(-1) for g in gradients]).double().cpu().numpy()
        return total

    def of_batch(self, samples: Tensor) -> tuple[Tensor, tuple[Tensor, ...]]:
        """What is `minimised` over the samples (indices), with its gradient by each of the weights."""
        samples = samples.to(self.x.device)
        error = field(self.module, self.x[samples], create_graph=True) - self.y[samples]
        if self.minimised == "nmse":
            loss = (error**2 @ self._of_outputs).mean()
        elif self.minimised == "mean_square":
            loss = (error**2).mean()
        else:
            on_q, on_p = error.chunk(2, dim=1)
            loss = (on_q.norm(dim=1) + on_p.norm(dim=1)).mean()
        gradients = torch.autograd.grad(loss, self.weights, allow_unused=True, materialize_grads=True)
        return loss.detach(), gradients
