"""How a run is shown: what of it is a parameter, what a tag, what a dataset, and which figures are metrics.

`described` is the content of a run's parameters.json: run_id, study, variant, the name of its dataset and its
hash, the trial with its settings, and the commit where there is one.
"""

import json
import math
from collections.abc import Mapping
from typing import Any

from mlflow.entities import Dataset, DatasetInput, InputTag, Param
from mlflow.utils.mlflow_tags import MLFLOW_DATASET_CONTEXT, MLFLOW_GIT_COMMIT, MLFLOW_RUN_NAME

from flexsurr.config.study import DEFAULT

Described = Mapping[str, Any]

RUN_KEY = "flexsurr.run_id"  # the tag by which a trial is found again
LONGEST_PARAMETER = 500
DIGITS = 32  # of a dataset's hash: MLflow takes 36
COUNTED = {"epochs", "epoch_limit", "best_epoch", "parameters", "rom_operations", "fom_operations"}
"""Numbers of a run that are no measurements of it; the loss curve has the epochs."""


def tags(described: Described) -> dict[str, str]:
    """By which runs are found, and told from one another."""
    found = {
        RUN_KEY: described["run_id"],
        MLFLOW_RUN_NAME: described["run_id"],
        "architecture": described["trial"].get("architecture"),
        MLFLOW_GIT_COMMIT: described.get("commit"),
        **{name: described.get(name) for name in ("study", "variant", "dataset", "dataset_sha256")},
    }
    return {name: str(value) for name, value in found.items() if value is not None}


def parameters(described: Described) -> list[Param]:
    """The settings of the trial, and its variant; what it takes none of is left out."""
    settings = {"variant": described["variant"], **described["trial"]}
    return [
        Param(name, str(value)[:LONGEST_PARAMETER]) for name, value in settings.items() if value is not None
    ]


def dataset(described: Described) -> DatasetInput:
    """What the run is trained on: its folder below the results' datasets, and its hash."""
    name, sha256 = described["dataset"], described["dataset_sha256"]
    folder = f"{described['study']}/{described['variant']}" + ("" if name == DEFAULT else f"-{name}")
    about = {
        "source_type": "local",
        "source": json.dumps({"uri": f"datasets/{folder}"}),
        "profile": json.dumps({"sha256": sha256}),
    }
    return DatasetInput(
        Dataset(folder, sha256[:DIGITS], **about), [InputTag(MLFLOW_DATASET_CONTEXT, "training")]
    )


def metrics(described: Described, figures: Mapping[str, Any]) -> dict[str, float]:
    """Those of the figures that were measured, and are finite: losses, errors, times; no settings."""
    return {
        name: float(value)
        for name, value in figures.items()
        if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
        if name not in described["trial"] and name not in COUNTED
    }
