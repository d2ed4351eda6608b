"""Networks trained by torch: what an optimiser minimises, by autograd, on any device.

The user's own networks, from their file on, and flexsurr's where they are to be trained on a device.
"""

import math
import os
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.own_network import OwnNetwork, own_network, read_source, sha256
from flexsurr.config.trial import AdamW, FirstOrder, Iterative, TorchModule
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import Network
from flexsurr.surrogates.scaling import StateScaling, scaled_rates, scaled_states
from flexsurr.surrogates.torch_module import Source, checked, field, weights_of
from flexsurr.surrogates.torch_surrogate import TorchSurrogate, torch_surrogate
from flexsurr.training.dataset import Dataset
from flexsurr.training.epochs import Optimiser
from flexsurr.training.lbfgs import LBFGS
from flexsurr.training.losses import output_weights
from flexsurr.training.networks import order_in_torch, to_torch
from flexsurr.training.objective import Minimised

PIECE = 16384  # samples of which a whole loss is made at a time
PRECISIONS = {"single": torch.float32, "double": torch.float64}
CPU = torch.device("cpu")
MOMENTS = ("exp_avg", "exp_avg_sq")
TRIED = 5  # samples with which a module is tried before it is trained


def device_of(name: str) -> torch.device:
    """The device `name`: cpu, cuda, or auto, which is cuda where there is one.

    Raises ConfigurationError for cuda on a machine without.
    """
    there = torch.cuda.is_available()
    if name == "cuda" and not there:
        raise ConfigurationError(["device: cuda is not available on this machine; allowed: cpu, auto"])
    if name == "cpu" or not there:
        return CPU
    # the same sums in the same order each time
    os.environ.setdefault("CUBLAS_WORKSPACE_CONFIG", ":4096:8")
    torch.use_deterministic_algorithms(True)
    return torch.device("cuda")


class TorchObjective:
    """The nmse of the field of `module` at scaled states `x` and scaled derivatives `y` (m, 2r).

    First-order steps may minimise another loss: see `batches.loss_and_gradient`. Samples are held in the
    precision and on the device of the module. The weights that a loss is asked for stay in the module; in
    the vectors of parameters and gradients they lie at `places` (by default one after the other).
    """

    def __init__(
        self,
        module: nn.Module,
        x: Array,
        y: Array,
        minimised: Minimised = "nmse",
        places: NDArray[np.int64] | None = None,
    ) -> None:
        self.module, self.minimised = module, minimised
        self.weights = weights_of(module)
        like = self.weights[0]
        count = sum(weight.numel() for weight in self.weights)
        self._places = np.arange(count) if places is None else places
        self.x, self.y, self._of_outputs = (
            torch.from_numpy(np.ascontiguousarray(a)).to(like) for a in (x, y, output_weights(y))
        )

    @property
    def parameters(self) -> Array:
        """The weights of the module."""
        parameters = np.empty(self._places.size)
        with torch.no_grad():
            parameters[self._places] = nn.utils.parameters_to_vector(self.weights).cpu().double().numpy()
        return parameters

    @parameters.setter
    def parameters(self, parameters: Array) -> None:
        with torch.no_grad():
            vector = torch.from_numpy(parameters[self._places]).to(self.weights[0])
            nn.utils.vector_to_parameters(vector, self.weights)

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
            found = torch.cat([g.reshape(-1) for g in gradients]).double().cpu().numpy()
            gradient[self._places] += share * found
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


class TorchAdam:
    """torch.optim.Adam, or with a `weight_decay` AdamW, at a constant rate or half a cosine over `epochs`.

    An epoch takes the samples in the order that the compiled `Adam` takes them in. Satisfies `Optimiser`.
    """

    finished = ""

    def __init__(
        self,
        objective: TorchObjective,
        *,
        learning_rate: float,
        batch_size: int,
        epochs: int,
        cosine: bool,
        weight_decay: float | None,
        seed: int,
    ) -> None:
        self._objective = objective
        self._learning_rate, self._batch_size = learning_rate, batch_size
        self._epochs, self._cosine, self._seed = epochs, cosine, seed
        self._torch: torch.optim.Optimizer = (
            torch.optim.Adam(objective.weights, lr=learning_rate)
            if weight_decay is None
            else torch.optim.AdamW(objective.weights, lr=learning_rate, weight_decay=weight_decay)
        )
        self._done = 0

    @property
    def parameters(self) -> Array:
        """The weights."""
        return self._objective.parameters

    def epoch(self) -> float:
        """One pass over the samples; the mean of the batches' losses."""
        objective = self._objective
        objective.module.train()
        if self._cosine:
            rate = self._learning_rate * 0.5 * (1.0 + math.cos(math.pi * self._done / self._epochs))
            for group in self._torch.param_groups:
                group["lr"] = rate
        # order and dropout are functions of seed and epoch: a resumed run needs no state of a generator
        order = np.random.default_rng([self._seed, self._done]).permutation(len(objective.x))
        total = torch.zeros((), dtype=torch.float64, device=objective.x.device)
        with torch.random.fork_rng():
            torch.manual_seed(int(np.random.SeedSequence([self._seed, self._done]).generate_state(1)[0]))
            for samples in torch.from_numpy(order).split(self._batch_size):
                loss, gradients = objective.of_batch(samples)
                for weight, gradient in zip(objective.weights, gradients, strict=True):
                    weight.grad = gradient
                self._torch.step()
                total += len(samples) * loss
        self._done += 1
        return float(total) / len(order)

    def state(self) -> dict[str, Array]:
        """Weights, both moments and the numbers of epochs and steps."""
        states = [self._torch.state[weight] for weight in self._objective.weights]
        moments = {
            name: torch.cat([state[name].reshape(-1) for state in states]).cpu().numpy() for name in MOMENTS
        }
        steps = np.array([float(state["step"]) for state in states])
        return {"parameters": self.parameters, "done": np.array(self._done), "steps": steps, **moments}

    def restore(self, state: dict[str, Array]) -> None:
        """Go on from a `state`."""
        self._objective.parameters = state["parameters"]
        self._done = int(state["done"])
        first = 0
        for weight, step in zip(self._objective.weights, state["steps"], strict=True):
            piece = slice(first, first + weight.numel())
            moments = {
                name: torch.from_numpy(state[name][piece].copy()).to(weight).view_as(weight)
                for name in MOMENTS
            }
            self._torch.state[weight] = {"step": torch.tensor(step, dtype=torch.float32), **moments}
            first = piece.stop


def begun(
    trial: Iterative, scaling: StateScaling, dataset: Dataset
) -> tuple[TorchSurrogate, TorchObjective, TorchObjective, Optimiser]:
    """Random weights, their losses over training and validation samples, and what will make them better.

    Raises ConfigurationError, of one line, where the file, its class or the device is not what it should be.
    """
    assert isinstance(trial, TorchModule)
    network = own_network(trial.architecture)
    assert network is not None
    surrogate = untrained(source_of(network, trial.sha256, trial.options, trial.seed), dataset, scaling)
    of = partial(objective_of, surrogate, device=device_of(trial.device))
    return surrogate, *_optimised(trial, dataset, of, surrogate.parameters)


def begun_on(
    device: torch.device, trial: Iterative, network: Network, dataset: Dataset
) -> tuple[Network, TorchObjective, TorchObjective, Optimiser]:
    """The same of a `network` of flexsurr's own, from its weights on."""

    def of(x: Array, dx: Array, minimised: Minimised = "nmse", precision: str = "double") -> TorchObjective:
        scaling = network.scaling
        scaled = scaled_states(scaling, x), scaled_rates(scaling, dx)
        module = to_torch(network, PRECISIONS[precision]).to(device)
        return TorchObjective(module, *scaled, minimised, order_in_torch(network))

    return network, *_optimised(trial, dataset, of, network.parameters)


def _optimised(
    trial: Iterative, dataset: Dataset, of: Callable[..., TorchObjective], start: Array
) -> tuple[TorchObjective, TorchObjective, Optimiser]:
    """The losses over training and validation samples, and the trial's optimiser from the weights `start`."""
    samples = dataset.x_train, dataset.dx_train
    training, validation = of(*samples), of(dataset.x_validation, dataset.dx_validation)
    if not isinstance(trial, FirstOrder):
        return training, validation, LBFGS(training, start)
    adam = TorchAdam(
        of(*samples, minimised=trial.loss, precision=trial.precision),
        learning_rate=trial.learning_rate,
        batch_size=trial.batch_size,
        epochs=trial.epochs,
        cosine=trial.optimiser.endswith("cosine"),
        weight_decay=trial.weight_decay if isinstance(trial, AdamW) else None,
        seed=trial.seed,
    )
    return training, validation, adam


def source_of(network: OwnNetwork, expected: str, options: Mapping[str, Any], seed: int) -> Source:
    """The class that a trial names; where `expected`, its file's hash, is empty, as the file is now."""
    try:
        found = expected or sha256(read_source(Path(), network))
    except ValueError as error:
        raise ConfigurationError([str(error)]) from None
    return Source(network, found, options, seed)


def untrained(source: Source, dataset: Dataset, scaling: StateScaling) -> TorchSurrogate:
    """The surrogate with the random weights that its module draws.

    Raises ConfigurationError, of one line, where the module is not what `torch_module` describes.
    """
    names, units = dataset.state_names, dataset.state_units
    module = source.build(len(names)).double()
    tried = dataset.x_train[np.linspace(0, len(dataset.x_train) - 1, TRIED).astype(int)]
    structure = checked(source.network, module, torch.from_numpy(scaled_states(scaling, tried)))
    return torch_surrogate(source, module, structure, scaling, names, units)


def objective_of(
    surrogate: TorchSurrogate,
    x: np.ndarray,
    dx: np.ndarray,
    minimised: Minimised = "nmse",
    precision: str = "double",
    device: torch.device = CPU,
) -> TorchObjective:
    """The loss of `surrogate`, with any weights, at states `x` and rates `dx` (m, 2r) in their units."""
    module = surrogate.source.build(len(surrogate.state_names))
    module = module.to(device, PRECISIONS[precision])
    objective = TorchObjective(
        module, scaled_states(surrogate.scaling, x), scaled_rates(surrogate.scaling, dx), minimised
    )
    objective.parameters = surrogate.parameters
    return objective
