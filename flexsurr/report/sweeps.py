"""What came of each sweep: the table sweeps.csv."""

from collections.abc import Mapping, Sequence

import pandas as pd

from flexsurr.report.trial_settings import in_words, settings_that_differ

COLUMNS = (
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

READ = ("study", "variant", "run_id", "architecture", "status", "reason", "processor_s", "validation_nmse")


def sweeps(runs: Mapping[str, Sequence[str]], metrics: pd.DataFrame) -> pd.DataFrame:
    """sweeps.csv: a row for each sweep, variant and architecture, the best first.

    `runs` has the run_ids of each sweep, `metrics` a row for each run. `outcome` is the best trial in words
    or, where none finished, that and the first reason; the median is that of the trials that finished.
    Raises KeyError naming a column of `metrics` that is missing.
    """
    missing = [name for name in READ if name not in metrics.columns]
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
                    **{status: (trials["status"] == status).sum() for status in COLUMNS[5:8]},
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
    frame = pd.DataFrame(rows, columns=list(COLUMNS))
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
