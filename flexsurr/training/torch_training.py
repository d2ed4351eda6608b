"""A network of the user's own, from its file to what an optimiser minimises."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.own_network import OwnNetwork, own_network, read_source, sha256
from flexsurr.config.trial import AdamW, FirstOrder, Iterative, TorchModule
from flexsurr.surrogates.scaling import StateScaling, scaled_rates, scaled_states
from flexsurr.surrogates.torch_module import Source, checked
from flexsurr.surrogates.torch_surrogate import TorchSurrogate, torch_surrogate
from flexsurr.training.dataset import Dataset
from flexsurr.training.lbfgs import LBFGS
from flexsurr.training.objective import Minimised
from flexsurr.training.optimiser import Optimiser
from flexsurr.training.torch_adam import TorchAdam
from flexsurr.training.torch_objective import TorchObjective, device_of

TRIED = 5  # samples with which a module is tried before it is trained


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
    training = objective_of(surrogate, dataset.x_train, dataset.dx_train, device=trial.device)
    validation = objective_of(surrogate, dataset.x_validation, dataset.dx_validation, device=trial.device)
    if not isinstance(trial, FirstOrder):
        return surrogate, training, validation, LBFGS(training, surrogate.parameters)
    adam = TorchAdam(
        objective_of(surrogate, dataset.x_train, dataset.dx_train, trial.loss, trial.device, trial.precision),
        learning_rate=trial.learning_rate,
        batch_size=trial.batch_size,
        epochs=trial.epochs,
        cosine=trial.optimiser.endswith("cosine"),
        weight_decay=trial.weight_decay if isinstance(trial, AdamW) else None,
        seed=trial.seed,
    )
    return surrogate, training, validation, adam


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
    device: str = "cpu",
    precision: str = "double",
) -> TorchObjective:
    """The loss of `surrogate`, with any weights, at states `x` and rates `dx` (m, 2r) in their units."""
    module = surrogate.source.build(len(surrogate.state_names))
    module = module.to(device_of(device), torch.float32 if precision == "single" else torch.float64)
    objective = TorchObjective(
        module, scaled_states(surrogate.scaling, x), scaled_rates(surrogate.scaling, dx), minimised
    )
    objective.parameters = surrogate.parameters
    return objective
