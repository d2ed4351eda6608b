"""Tables of all runs of a study: architectures.csv, seeds.csv and sweeps.csv."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from flexsurr.report.trial_settings import in_words, settings_that_differ

SETTING = ("variant", "architecture", "normalisation", "scaling", "dataset")

ARCHITECTURE_COLUMNS = (
    "study",
    *SETTING,
    "hidden",
    "activation",
    "degree",
    "mass_matrix",
    "optimiser",
    "seed",
    "run_id",
    "status",
    "parameters",
    "wall_s",
    "train_nmse",
    "validation_nmse",
)

SCORED = (  # finished runs only
    "held_out_nmse",
    "long_response_error_percent_median",
    "long_response_error_percent_worst",
    "diverged",
)


def architectures(metrics: pd.DataFrame) -> pd.DataFrame:
    """architectures.csv: every run by its setting, with its nmse on the held-out trajectories, and by state.

    train_nmse and validation_nmse are on the run's own dataset; held_out_nmse, and held_out_nmse_<state>,
    on the held-out trajectories of the study's, the same for all. Errors of long free responses in percent
    of the peak. Figures of runs that failed, and of responses that did not end, are empty. Raises KeyError
    naming a column that is missing.
    """
    missing = [name for name in ARCHITECTURE_COLUMNS if name not in metrics.columns]
    if missing:
        raise KeyError(f"columns missing: {', '.join(missing)}")
    frame = metrics.reindex(columns=[*ARCHITECTURE_COLUMNS, *SCORED])
    by_state: list[dict[str, float | None]] = [
        row if isinstance(row, dict) else {}
        for row in metrics.get("held_out_nmse_by_state", pd.Series([{}] * len(frame)))
    ]
    states = dict.fromkeys(state for row in by_state for state in row)
    for state in states:
        frame[f"held_out_nmse_{state}"] = pd.Series(
            [row.get(state) for row in by_state], index=frame.index, dtype=float
        )
    order = ["study", *SETTING, "long_response_error_percent_worst", "run_id"]
    return frame.sort_values(order, ignore_index=True)


WITHOUT_SEED = [
    "study",
    "variant",
    "configuration",
    "architecture",
    "hidden",
    "activation",
    "degree",
    "optimiser",
]

SCORES = ["long_response_error_percent_worst", "diverged"]  # of finished runs only

SEEDS_COLUMNS = (
    *WITHOUT_SEED,
    "seeds",
    "failed",
    "wall_s_mean",
    "wall_s_std",
    "validation_nmse_mean",
    "validation_nmse_std_decades",
    "long_response_error_percent_mean",
    "long_response_error_percent_std",
    "diverged",
)


def seeds(metrics: pd.DataFrame) -> pd.DataFrame:
    """seeds.csv: mean and spread over the seeds of each configuration of a sweep.

    `metrics` has a row for each run. `configuration` is the run_id that the run would have with seed 0.
    Losses run over decades: their mean is geometric, their standard deviation that of log10. Failed runs
    are counted and left out; `diverged` counts long responses that did not reach their end. A standard
    deviation of one seed is empty. Raises KeyError naming a column that is missing.
    """
    missing = [
        name for name in (*WITHOUT_SEED, "status", "wall_s", "validation_nmse") if name not in metrics.columns
    ]
    if missing:
        raise KeyError(f"columns missing: {', '.join(missing)}")
    metrics = metrics.reindex(columns=[*metrics.columns.difference(SCORES, sort=False), *SCORES])
    rows = []
    for names, runs in metrics.groupby(WITHOUT_SEED, dropna=False, sort=False):
        finished = runs[runs["status"] == "finished"]
        losses = np.log10(finished["validation_nmse"].astype(float))
        errors = finished[SCORES[0]].astype(float)
        rows.append(
            dict(zip(WITHOUT_SEED, names, strict=True))
            | {
                "seeds": len(runs),
                "failed": len(runs) - len(finished),
                "wall_s_mean": finished["wall_s"].mean(),
                "wall_s_std": finished["wall_s"].std(),
                "validation_nmse_mean": 10.0 ** losses.mean(),
                "validation_nmse_std_decades": losses.std(),
                "long_response_error_percent_mean": errors.mean(),
                "long_response_error_percent_std": errors.std(),
                "diverged": finished["diverged"].sum(),
            }
        )
    frame = pd.DataFrame(rows, columns=list(SEEDS_COLUMNS))
    return frame.sort_values(["study", "variant", "validation_nmse_mean"], ignore_index=True)


SWEEPS_COLUMNS = (
    "study",
    "sweep",
    "variant",
    "architecture",
    "trials",
    "finished",
    "stopped",
    "failed",
    "processor_s",
    "validation_nmse_median",
    "validation_nmse_best",
    "long_response_error_percent_best",
    "best_run_id",
    "outcome",
)

READ_OF_SWEEPS = (
    "study",
    "variant",
    "run_id",
    "architecture",
    "status",
    "reason",
    "processor_s",
    "validation_nmse",
)


def sweeps(runs: Mapping[str, Sequence[str]], metrics: pd.DataFrame) -> pd.DataFrame:
    """sweeps.csv: a row for each sweep, variant and architecture, the best first.

    `runs` has the run_ids of each sweep, `metrics` a row for each run. `outcome` is the best trial in words
    or, where none finished, that and the first reason; the median is that of the trials that finished.
    Raises KeyError naming a column of `metrics` that is missing.
    """
    missing = [name for name in READ_OF_SWEEPS if name not in metrics.columns]
    if missing:
        raise KeyError(f"columns missing: {', '.join(missing)}")
    error = "long_response_error_percent_worst"
    metrics = metrics.reindex(columns=[*metrics.columns, *({error} - {*metrics.columns})])
    settings = settings_that_differ(metrics).drop(columns="architecture")
    rows = []
    for sweep, keys in runs.items():
        of_sweep = metrics[metrics["run_id"].isin(keys)]
        for names, trials in of_sweep.groupby(["study", "variant", "architecture"], sort=False):
            study, variant, architecture = names
            finished = trials[trials["status"] == "finished"].sort_values(["validation_nmse", "run_id"])
            best = finished.iloc[0] if len(finished) else None
            rows.append(
                {
                    "study": study,
                    "sweep": sweep,
                    "variant": variant,
                    "architecture": architecture,
                    "trials": len(trials),
                    **{status: (trials["status"] == status).sum() for status in SWEEPS_COLUMNS[5:8]},
                    "processor_s": trials["processor_s"].sum(),
                    "validation_nmse_median": finished["validation_nmse"].astype(float).median(),
                    "validation_nmse_best": None if best is None else best["validation_nmse"],
                    "long_response_error_percent_best": None if best is None else best[error],
                    "best_run_id": None if best is None else best["run_id"],
                    "outcome": _without_one(trials)
                    if best is None
                    else in_words(settings.loc[finished.index[0]]),
                }
            )
    frame = pd.DataFrame(rows, columns=list(SWEEPS_COLUMNS))
    order = ["study", "sweep", "variant", "validation_nmse_best", "architecture"]
    return frame.sort_values(order, ignore_index=True)


def _without_one(trials: pd.DataFrame) -> str:
    """What to know of trials of which none finished."""
    if (trials["status"] == "failed").all():
        said = "every trial failed"
    elif (trials["status"] == "stopped").all():
        said = "every trial was stopped"
    else:
        said = "no trial finished"
    return f"{said}; the first: {trials['reason'].iloc[0]}"
