"""From datasets to fitted surrogates: optimisers, sweeps, selection."""

from typing import TYPE_CHECKING, Any

from flexsurr.training.dataset import Dataset, ShardedDataset, load_dataset, split_dataset
from flexsurr.training.fitting import Fit, fit
from flexsurr.training.learned_maps import fit_network_map, fit_polynomial_map
from flexsurr.training.losses import nmse, nmse_per_state
from flexsurr.training.selection import select
from flexsurr.training.sweep import expand, run_id

if TYPE_CHECKING:
    from flexsurr.training.networks import torch_model

__all__ = [
    "Dataset",
    "Fit",
    "ShardedDataset",
    "expand",
    "fit",
    "fit_network_map",
    "fit_polynomial_map",
    "load_dataset",
    "nmse",
    "nmse_per_state",
    "run_id",
    "select",
    "split_dataset",
    "torch_model",
]


def __getattr__(name: str) -> Any:
    """`torch_model` when it is asked for: importing torch takes seconds that nothing else here needs."""
    if name != "torch_model":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from flexsurr.training.networks import torch_model

    return torch_model
