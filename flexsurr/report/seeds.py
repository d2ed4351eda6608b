"""What the random start of a training is worth: runs that differ in nothing but their seed, as one row."""

import numpy as np
import pandas as pd

WHOLE = ["study", "variant", "configuration", "architecture", "hidden", "activation", "degree", "optimiser"]

JUDGED = ["long_response_error_percent_worst", "diverged"]  # of finished runs only

SEEDS_COLUMNS = (
    *WHOLE,
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
        name for name in (*WHOLE, "status", "wall_s", "validation_nmse") if name not in metrics.columns
    ]
    if missing:
        raise KeyError(f"columns missing: {', '.join(missing)}")
    metrics = metrics.reindex(columns=[*metrics.columns.difference(JUDGED, sort=False), *JUDGED])
    rows = []
    for names, runs in metrics.groupby(WHOLE, dropna=False, sort=False):
        finished = runs[runs["status"] == "finished"]
        losses = np.log10(finished["validation_nmse"].astype(float))
        errors = finished[JUDGED[0]].astype(float)
        rows.append(
            dict(zip(WHOLE, names, strict=True))
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
