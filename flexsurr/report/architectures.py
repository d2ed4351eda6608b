"""Every architecture in every setting: the table architectures.csv."""

import pandas as pd

SETTING = ("variant", "architecture", "normalisation", "scaling", "dataset")

ARCHITECTURE_COLUMNS = (
    "study",
    *SETTING,
    "hidden",
    "activation",
    "degree",
    "optimiser",
    "seed",
    "run_id",
    "status",
    "parameters",
    "wall_s",
    "train_nmse",
    "validation_nmse",
)

JUDGED = (  # finished runs only
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
    frame = metrics.reindex(columns=[*ARCHITECTURE_COLUMNS, *JUDGED])
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
