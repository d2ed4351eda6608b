"""Every architecture in every setting: the table architectures.csv, and the figure of it."""

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.report.style import (
    BLACK,
    GREY,
    PAGE_IN,
    VARIANTS,
    colour,
    label,
    letter,
    logarithmic,
    new_figure,
    styled,
)

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

LARGEST_PERCENT = 1e3
"""Errors beyond, and responses that did not reach their end, stand at this height."""

MARKERS = {
    ("mass", "canonical"): "o",
    ("mass", "per_feature"): "s",
    ("unit", "canonical"): "^",
    ("unit", "per_feature"): "D",
}
"""By the normalisation of the modes and the scaling of the states."""


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


@styled
def architecture_errors(metrics: pd.DataFrame) -> Figure:
    """Error of a long response against error of the field, one point a run, one panel a variant.

    Colours are architectures, markers the normalisation and the scaling; a filled marker was trained on the
    study's own dataset, an open one on a further dataset. On the dashed line stand the runs one of whose
    responses did not reach its end.
    """
    variants = [variant for variant in VARIANTS if variant in set(metrics["variant"])]
    figure = new_figure(PAGE_IN, 3.9)
    axes = figure.subplots(1, len(variants), sharex=True, sharey=True, squeeze=False)[0]
    judged = metrics[metrics["held_out_nmse"].notna()]
    for ax, variant in zip(axes, variants, strict=True):
        for _, run in judged[judged["variant"] == variant].iterrows():
            _point(ax, run)
        ax.axhline(LARGEST_PERCENT, color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
        logarithmic(ax, x=True, y=True)
        ax.set(xlabel="nmse of the field on held-out trajectories [–]")
        ax.set_title(VARIANTS[variant], loc="left")
    axes[0].set_ylabel("worst tip error of long responses [% of the peak]")
    figure.legend(handles=_handles(judged), loc="outside upper center", ncols=4)
    letter(axes)
    return figure


def _point(ax: Axes, run: Any) -> None:
    error = run["long_response_error_percent_worst"]
    line = colour(run["architecture"])
    ax.plot(
        max(run["held_out_nmse"], 1e-30),
        LARGEST_PERCENT if pd.isna(error) else min(error, LARGEST_PERCENT),
        marker=MARKERS[run["normalisation"], run["scaling"]],
        color=line,
        markerfacecolor=line if run["dataset"] == "default" else "white",
        markersize=5,
        linestyle="",
        zorder=3,
    )


def _handles(judged: pd.DataFrame) -> list[Line2D]:
    handles = [
        Line2D([], [], color=colour(name), marker="o", linestyle="", label=label(name))
        for name in sorted(set(judged["architecture"]))
    ]
    used = set(zip(judged["normalisation"], judged["scaling"], strict=True))
    for setting, marker in MARKERS.items():
        if setting in used:
            modes, scaling = setting
            text = (
                f"{'unit-norm' if modes == 'unit' else 'mass-normalised'} modes, {scaling.replace('_', ' ')}"
            )
            handles.append(Line2D([], [], color=BLACK, marker=marker, linestyle="", label=text))
    for name in sorted(set(judged["dataset"])):
        fill = BLACK if name == "default" else "white"
        text = "the study's dataset" if name == "default" else f"dataset {name}"
        handles.append(
            Line2D([], [], color=BLACK, marker="o", markerfacecolor=fill, linestyle="", label=text)
        )
    return handles
