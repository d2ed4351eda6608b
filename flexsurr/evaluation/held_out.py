"""How well a surrogate's field fits that of the reference where no training has looked."""

from typing import Any

import numpy as np

from flexsurr.training import Dataset
from flexsurr.training.losses import FieldErrors


def held_out_errors(surrogate: Any, dataset: Dataset) -> dict[str, Any]:
    """The nmse of the surrogate's derivatives on the validation trajectories of `dataset`.

    Keys as in a run's metrics: held_out_nmse, the mean over the states of the mean squared error over the
    variance of the target, and held_out_nmse_by_state, the same for each state by its name. One dataset
    for all runs of a study, whatever each was trained on. A figure that has no finite value is None.
    """
    error = FieldErrors.over(surrogate, dataset.validation_blocks()).nmse_per_state()
    by_state: dict[str, float | None] = dict(
        zip(dataset.state_names, map(_finite, error.tolist()), strict=True)
    )
    return {"held_out_nmse": _finite(float(error.mean())), "held_out_nmse_by_state": by_state}


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
