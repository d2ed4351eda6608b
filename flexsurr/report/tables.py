"""The tables: data frames whose columns are a contract, and their files."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from flexsurr.config.trial import FIELDS, MAPS, dimensions
from flexsurr.evaluation.columns import (
    ACCURACY_COLUMNS,
    COST_COLUMNS,
    CROSSOVER_COLUMNS,
    FREQUENCY_COLUMNS,
    MODE_COLUMNS,
    STATIC_COLUMNS,
)
from flexsurr.evaluation.published import published_loss
from flexsurr.report.run_tables import architectures, seeds, sweeps
from flexsurr.storage import replacing

TRAINING_COLUMNS = (
    "study",
    "variant",
    "run_id",
    "architecture",
    "configurations",
    "hidden",
    "activation",
    "degree",
    "terms",
    "options",
    "scaling",
    "samples_per_trajectory",
    "potential",
    "mass_matrix",
    "optimiser",
    "learning_rate",
    "weight_decay",
    "batch_size",
    "precision",
    "device",
    "loss",
    "keep",
    "patience",
    "time_limit_s",
    "give_up",
    "seed",
    "dataset",
    "status",
    "reason",
    "epoch_limit",
    "epochs",
    "best_epoch",
    "wall_s",
    "processor_s",
    "parameters",
    "final_loss",
    "train_nmse",
    "validation_nmse",
    "best_validation_nmse",
    "published_loss",
    "sampling",
    "lattice",
    "networks",
    "inputs",
)
"""Every setting of a trial has its column, empty for a run that takes none; those of maps are the last."""

LEARNED_LOAD_COLUMNS = (
    "study",
    "variant",
    "map",
    "form",
    "parameters",
    "tip_rms_over_length",
    "twist_largest_error_rad",
    "force_relative_error",
)

ROLLOUT_COLUMNS = (
    "study",
    "model",
    "trajectory",
    "samples",
    "duration_s",
    "completed",
    "error_percent",
    "own_energy_drift_percent",
)

ROLLOUT_COST_COLUMNS = (
    "study",
    "model",
    "implementation",
    "integrator",
    "simulations",
    "duration_s",
    "right_hand_sides",
    "us_per_right_hand_side",
    "wall_s_mean",
    "wall_s_std",
    "error_percent",
    "diverged",
)


def static_tip(statics: pd.DataFrame) -> pd.DataFrame:
    """static_tip.csv: tip position [m] against dead tip load [N], ascending."""
    return _columns(statics, STATIC_COLUMNS).sort_values("load_N", ignore_index=True)


def natural_frequencies(frequencies: pd.DataFrame) -> pd.DataFrame:
    """natural_frequencies.csv: full order, reduced order, and what is published [rad/s]."""
    return _columns(frequencies, FREQUENCY_COLUMNS)


def training(metrics: pd.DataFrame) -> pd.DataFrame:
    """training.csv: every run, also those that did not finish; best validation first in each variant."""
    published = [
        published_loss({str(key): value for key, value in run.items()}) for run in metrics.to_dict("records")
    ]
    settings = [name for kind in (FIELDS, MAPS) for name in dimensions(kind) if name not in metrics.columns]
    whole = metrics.assign(published_loss=published, **dict.fromkeys(settings))
    frame = _columns(whole, TRAINING_COLUMNS)
    return frame.sort_values(["study", "variant", "validation_nmse", "run_id"], ignore_index=True)


def cost(costs: pd.DataFrame) -> pd.DataFrame:
    """cost.csv: every model × implementation × integrator, by study, variant and response."""
    return _columns(costs, COST_COLUMNS)


def learned_loads(errors: pd.DataFrame) -> pd.DataFrame:
    """learned_loads.csv: what the maps of a learned load err by."""
    return _columns(errors, LEARNED_LOAD_COLUMNS)


def rollout_errors(errors: pd.DataFrame) -> pd.DataFrame:
    """rollout_errors.csv: every selected surrogate on every held-out trajectory."""
    return _columns(errors, ROLLOUT_COLUMNS)


def rollout_cost(costs: pd.DataFrame) -> pd.DataFrame:
    """rollout_cost.csv: every surrogate × implementation × integrator."""
    return _columns(costs, ROLLOUT_COST_COLUMNS)


def airliner_accuracy(accuracy: pd.DataFrame) -> pd.DataFrame:
    """airliner_accuracy.csv: every output of each selected map."""
    return _columns(accuracy, ACCURACY_COLUMNS)


def airliner_modes(modes: pd.DataFrame) -> pd.DataFrame:
    """airliner_modes.csv: eigenvalues in trim, with the lattice and with the network."""
    return _columns(modes, MODE_COLUMNS)


def crossover(rivals: pd.DataFrame) -> pd.DataFrame:
    """crossover.csv: for each number of modes the reduced model, then its rivals, the cheapest first."""
    frame = _columns(rivals, CROSSOVER_COLUMNS)
    is_rival = frame["model"] != "rom"
    return frame.assign(is_rival=is_rival).sort_values(["modes", "is_rival", "wall_s"], ignore_index=True)[
        list(CROSSOVER_COLUMNS)
    ]


def as_it_is(frame: pd.DataFrame) -> pd.DataFrame:
    """The whole of what an evaluation wrote."""
    return frame


TABULATE: dict[str, Callable[..., pd.DataFrame]] = {
    tabulate.__name__: tabulate
    for tabulate in (
        static_tip,
        natural_frequencies,
        sweeps,
        training,
        architectures,
        seeds,
        cost,
        learned_loads,
        rollout_errors,
        rollout_cost,
        airliner_accuracy,
        airliner_modes,
        crossover,
    )
} | dict.fromkeys(
    ("airliner_elastic_modes", "airliner_left_out_modes", "airliner_cost", "airliner_limits"), as_it_is
)
"""The functions that make the tables of the catalogue, by their names."""


def save_table(frame: pd.DataFrame, path: Path) -> None:
    """Write `frame` as CSV, nine significant digits, there whole or not at all."""
    with replacing(path) as beside:
        frame.to_csv(beside, index=False, float_format="%.9g", lineterminator="\n")


def _columns(frame: pd.DataFrame, names: Sequence[str]) -> pd.DataFrame:
    """Exactly these columns; KeyError naming those that are missing."""
    missing = [name for name in names if name not in frame.columns]
    if missing:
        raise KeyError(f"columns missing: {', '.join(missing)}")
    return frame[list(names)].reset_index(drop=True)
