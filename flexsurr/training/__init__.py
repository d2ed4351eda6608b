"""From datasets to fitted surrogates: optimisers and sweeps.

A name is imported when it is asked for: the kernels take seconds that planning a sweep does not need, and
torch takes seconds that nothing else here needs.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from flexsurr.training.dataset import Dataset, ShardedDataset, load_dataset, split_dataset
    from flexsurr.training.epochs import Fit
    from flexsurr.training.fitting import fit
    from flexsurr.training.losses import nmse
    from flexsurr.training.map_fitting import fit_map, fit_network_map, fit_polynomial_map
    from flexsurr.training.networks import torch_model
    from flexsurr.training.sweep import expand, run_id

__all__ = [
    "Dataset",
    "Fit",
    "ShardedDataset",
    "expand",
    "fit",
    "fit_map",
    "fit_network_map",
    "fit_polynomial_map",
    "load_dataset",
    "nmse",
    "run_id",
    "split_dataset",
    "torch_model",
]

_MODULES = {
    "Dataset": "dataset",
    "Fit": "epochs",
    "ShardedDataset": "dataset",
    "expand": "sweep",
    "fit": "fitting",
    "fit_map": "map_fitting",
    "fit_network_map": "map_fitting",
    "fit_polynomial_map": "map_fitting",
    "load_dataset": "dataset",
    "nmse": "losses",
    "run_id": "sweep",
    "split_dataset": "dataset",
    "torch_model": "networks",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
