"""From datasets to fitted surrogates: optimisers, sweeps, selection.

A name is imported when it is asked for: the kernels take seconds that planning a sweep does not need, and
torch takes seconds that nothing else here needs.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from flexsurr.training.dataset import Dataset, ShardedDataset, load_dataset, split_dataset
    from flexsurr.training.fit_result import Fit
    from flexsurr.training.fitting import fit
    from flexsurr.training.learned_maps import fit_network_map, fit_polynomial_map
    from flexsurr.training.losses import nmse
    from flexsurr.training.networks import torch_model
    from flexsurr.training.selection import select
    from flexsurr.training.sweep import expand, run_id

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
    "run_id",
    "select",
    "split_dataset",
    "torch_model",
]

_MODULES = {
    "Dataset": "dataset",
    "Fit": "fit_result",
    "ShardedDataset": "dataset",
    "expand": "sweep",
    "fit": "fitting",
    "fit_network_map": "learned_maps",
    "fit_polynomial_map": "learned_maps",
    "load_dataset": "dataset",
    "nmse": "losses",
    "run_id": "sweep",
    "select": "selection",
    "split_dataset": "dataset",
    "torch_model": "networks",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
