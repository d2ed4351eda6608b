"""Every trial of a study by what it costs and what it errs: where a dearer surrogate is worth it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.evaluation.selection import COST, ERROR, choose
from flexsurr.report.labels import freeze_layout, place_labels
from flexsurr.report.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    NAMES,
    ORANGE,
    PAGE_IN,
    PURPLE,
    VARIANTS,
    VERMILION,
    colour,
    fitting_legend,
    label,
    letter,
    logarithmic,
    new_figure,
    styled,
)

REFERENCES = {"rom_operations": ("rom", BLACK), "fom_operations": ("fom", ORANGE)}
"""What one right-hand side of the compiled reference models takes."""

FRONT = "#C9C9C9"
LEAST = 1e-9
"""Errors [%] of less are rounding, and are drawn there."""

MAPS = {"network": BLUE, "quadratic": GREEN, "linear": PURPLE}

VALIDATION = "validation_nmse"
"""The error of a map, which has no response."""


@styled
def pareto(selection: Mapping[str, Any], metrics: pd.DataFrame) -> Figure:
    """The operations of one evaluation of every trial against its error, and which is chosen.

    `metrics`: a row for each run, of which `operations` and the worst error of long responses (of a map, the
    validation nmse) are shown; `selection`: the study's rule of choice. One panel for each variant of a
    field. The grey line joins what nothing beats in both; a ring is around the one that the rule chooses,
    dashed the largest error that it allows. Named are those, and what it chooses of each architecture.
    Upright lines are the compiled reference models. Runs that diverged, or that call Python, have no place.
    """
    metrics = metrics.reindex(columns=list(dict.fromkeys([*metrics, COST, ERROR, *REFERENCES])))
    variants = [variant for variant in VARIANTS if variant in set(metrics["variant"])]
    panels = [(VARIANTS[variant], metrics[metrics["variant"] == variant]) for variant in variants]
    error = ERROR if variants else VALIDATION
    figure = new_figure(PAGE_IN, 0.9 + 3.0 * max(len(panels), 1))
    axes = figure.subplots(max(len(panels), 1), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    shown = [(title, _with_a_place(part, error)) for title, part in panels or [("", metrics)]]
    for ax, (title, _) in zip(axes, shown, strict=True):
        logarithmic(ax, x=True, y=True)
        ax.set_title(title, loc="left")
        ax.set_ylabel("worst error of long responses [%]" if error == ERROR else "validation nmse")
    axes[-1].set_xlabel("operations of one evaluation [–]")
    _limits(axes[0], pd.concat([part for _, part in shown]), error, selection)
    _legend(figure, pd.concat([part for _, part in shown]), selection)
    letter(axes if len(axes) > 1 else [])
    freeze_layout(figure)
    for ax, (_, part) in zip(axes, shown, strict=True):
        _panel(ax, part, error, selection)
    return figure


def front(trials: pd.DataFrame, error: str = ERROR) -> pd.DataFrame:
    """The trials that no other beats in both operations and error, cheapest first."""
    ordered = trials.sort_values([COST, error, "run_id"])
    return ordered[ordered[error] < ordered[error].cummin().shift(fill_value=np.inf)]


def _with_a_place(trials: pd.DataFrame, error: str) -> pd.DataFrame:
    kept = trials[(trials["status"] == "finished") & trials[COST].notna() & trials[error].notna()]
    if "diverged" in kept:
        kept = kept[~(kept["diverged"] > 0)]
    return kept.assign(**{COST: kept[COST].astype(float), error: kept[error].astype(float).clip(lower=LEAST)})


def _panel(ax: Axes, trials: pd.DataFrame, error: str, selection: Mapping[str, Any]) -> None:
    limit = _limit(selection)
    if limit:
        ax.axhline(limit, color=VERMILION, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
    for column, (model, shade) in REFERENCES.items():
        for operations in trials[column].dropna().unique()[:1]:
            ax.axvline(operations, color=shade, linewidth=0.8, zorder=1)
            ax.annotate(
                f"{NAMES[model]}, compiled",
                (operations, 0.98),
                xycoords=("data", "axes fraction"),
                xytext=(-2, 0),
                textcoords="offset points",
                rotation=90,
                ha="right",
                va="top",
                fontsize=6,
                color=shade,
            )
    best = front(trials, error)
    ax.step(best[COST], best[error], where="post", color=FRONT, linewidth=3.0, zorder=1)
    for architecture, part in trials.groupby("architecture", sort=False):
        ax.plot(part[COST], part[error], "o", color=_shade(str(architecture)), markersize=4.2, zorder=3)
    named = best
    if error == ERROR and len(trials):
        parts = [trials, *(part for _, part in trials.groupby("architecture", sort=False))]
        chosen, *of_each = (_chosen(part, limit) for part in parts)
        ax.plot(chosen[COST], chosen[error], "o", color=BLACK, markersize=9, markerfacecolor="none", zorder=4)
        named = pd.concat([best, *of_each]).drop_duplicates("run_id")
    place_labels(
        ax,
        list(zip(named[COST], named[error], strict=True)),
        [_settings(trial) for _, trial in named.iterrows()],
        [_shade(architecture) for architecture in named["architecture"]],
        obstacles=list(zip(trials[COST], trials[error], strict=True)),
    )


def _chosen(trials: pd.DataFrame, limit: float | None) -> pd.DataFrame:
    """The row of the trial that the rule chooses."""
    columns = trials[["run_id", COST, ERROR]]
    runs = {str(row.iloc[0]): {str(name): row[name] for name in row.index} for _, row in columns.iterrows()}
    return trials[(trials["run_id"] == choose(runs, limit)).to_numpy()]


def _settings(trial: "pd.Series[Any]") -> str:
    """A trial in a few words: what its size is, and its activation."""
    found = [_name(str(trial["architecture"]))]
    if not _missing(trial.get("degree")):
        found.append(f"degree {trial['degree']:.0f}")
    found += [str(trial[key]) for key in ("hidden", "activation") if not _missing(trial.get(key))]
    return " ".join(found).replace("_", " ")


def _shade(architecture: str) -> str:
    return MAPS.get(architecture) or colour(architecture)


def _name(architecture: str) -> str:
    return architecture if architecture in MAPS else label(architecture)


def _missing(value: Any) -> bool:
    return value is None or value == "" or value != value


def _limits(ax: Axes, trials: pd.DataFrame, error: str, selection: Mapping[str, Any]) -> None:
    """Limits that hold every point and line, and leave room for labels; shared by all panels."""
    costs = pd.concat([trials[column] for column in (COST, *REFERENCES)]).dropna().astype(float)
    errors = [*trials[error], *([_limit(selection)] if _limit(selection) else [])]
    if costs.empty:
        return
    ax.set_xlim(costs.min() / 2.0, costs.max() * 2.0)
    ax.set_ylim(min(errors) / 4.0, max(errors) * 4.0)


def _limit(selection: Mapping[str, Any]) -> float | None:
    limit: float | None = selection.get("error_at_most_percent")
    return limit


def _legend(figure: Figure, trials: pd.DataFrame, selection: Mapping[str, Any]) -> None:
    handles = [
        Line2D([], [], color=_shade(name), marker="o", linestyle="", label=_name(name))
        for name in dict.fromkeys(trials["architecture"])
    ]
    handles.append(Line2D([], [], color=FRONT, linewidth=3.0, label="nothing beats these in both"))
    if ERROR in trials and trials[ERROR].notna().any():
        ring = Line2D([], [], color=BLACK, marker="o", markersize=9, markerfacecolor="none", linestyle="")
        ring.set_label("chosen")
        handles.append(ring)
    if _limit(selection):
        text = f"{_limit(selection):g} %: the rule of choice"
        handles.append(Line2D([], [], color=VERMILION, linewidth=0.8, linestyle=(0, (4, 2)), label=text))
    fitting_legend(figure, handles or [Line2D([], [], color=GREY)], "outside upper center")
