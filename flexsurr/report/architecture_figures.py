"""Errors of every architecture in every setting."""

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.config.study import CONFIGURATIONS
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

LARGEST_PERCENT = 1e3
"""Errors beyond, and responses that did not reach their end, stand at this height."""

SCORES = ("held_out_nmse", "long_response_error_percent_worst")
"""What only runs have that finished."""

BY_PAIRS = "by_pairs"
"""How the port-Hamiltonian forms and polynomials scale the states; their trials have no choice of it."""

PALE = "#C8C8C8"

MARKERS = {
    ("mass", BY_PAIRS): "o",
    ("mass", "canonical"): "h",
    ("mass", "per_feature"): "s",
    ("mass", "min_max"): "P",
    ("unit", BY_PAIRS): "^",
    ("unit", "canonical"): "v",
    ("unit", "per_feature"): "D",
    ("unit", "min_max"): "X",
}
"""By the normalisation of the modes and the scaling of the states."""


@styled
def architecture_errors(metrics: pd.DataFrame) -> Figure:
    """Error of a long response against error of the field, one point a run, one panel a variant.

    Colours are architectures, markers the normalisation and the scaling; a filled marker was trained on the
    study's own dataset, an open one on a further dataset. On the dashed line stand the runs one of whose
    responses did not reach its end.
    """
    # where no run has finished, none says what it errs by
    metrics = metrics.reindex(columns=[*metrics.columns, *(name for name in SCORES if name not in metrics)])
    variants = [variant for variant in VARIANTS if variant in set(metrics["variant"])]
    figure = new_figure(PAGE_IN, 3.9)
    axes = figure.subplots(1, len(variants), sharex=True, sharey=True, squeeze=False)[0]
    scored = metrics[metrics["held_out_nmse"].notna()].fillna({"scaling": BY_PAIRS})
    for ax, variant in zip(axes, variants, strict=True):
        for _, run in scored[scored["variant"] == variant].iterrows():
            _point(ax, run)
        ax.axhline(LARGEST_PERCENT, color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
        logarithmic(ax, x=True, y=True)
        ax.set(xlabel="nmse of the field on held-out trajectories [–]")
        ax.set_title(VARIANTS[variant], loc="left")
    axes[0].set_ylabel("worst tip error of long responses [% of the peak]")
    figure.legend(handles=_handles(scored), loc="outside upper center", ncols=4)
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
        markerfacecolor=_fill(run["dataset"], line),
        markersize=5,
        linestyle="",
        zorder=3,
    )


def _fill(dataset: str, line: str) -> str:
    """Full for the study's own dataset, pale for sampled configurations, none for further datasets."""
    return {"default": line, CONFIGURATIONS: PALE}.get(dataset, "white")


def _handles(scored: pd.DataFrame) -> list[Line2D]:
    handles = [
        Line2D([], [], color=colour(name), marker="o", linestyle="", label=label(name))
        for name in sorted(set(scored["architecture"]))
    ]
    used = set(zip(scored["normalisation"], scored["scaling"], strict=True))
    for setting, marker in MARKERS.items():
        if setting in used:
            modes, scaling = setting
            text = (
                f"{'unit-norm' if modes == 'unit' else 'mass-normalised'} modes, {scaling.replace('_', ' ')}"
            )
            handles.append(Line2D([], [], color=BLACK, marker=marker, linestyle="", label=text))
    for name in sorted(set(scored["dataset"])):
        told = {"default": "the study's dataset", CONFIGURATIONS: "no simulation"}
        text, fill = told.get(name, f"dataset {name}"), _fill(name, BLACK)
        handles.append(
            Line2D([], [], color=BLACK, marker="o", markerfacecolor=fill, linestyle="", label=text)
        )
    return handles
