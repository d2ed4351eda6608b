"""The figure of the answer: how much faster each surrogate is, and what it loses."""

from collections.abc import Iterable, Mapping
from itertools import cycle
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from flexsurr.report.answer import ALLOWED_PERCENT, name_of, times
from flexsurr.report.labels import freeze_layout, place_labels
from flexsurr.report.style import (
    OWN_COLOURS,
    PAGE_IN,
    VARIANTS,
    colour,
    family,
    fitting_legend,
    has_family,
    label,
    letter,
    logarithmic,
    new_figure,
    styled,
)

PAYS = "#E3F1E6"
"""The background where a surrogate pays."""

MARKERS = {"free": "o", "forced": "s", "manoeuvre": "D"}

HOLLOW = "as_printed"
"""The variant whose points are hollow."""

LEAST_PERCENT = 1e-6
"""Smaller losses stand at this height."""


@styled
def answer_figure(table: pd.DataFrame) -> Figure:
    """Loss against speed, one point for each row of the table of `answer`, one panel a study.

    Right of the line a surrogate is faster than the fastest compiled reference, below the other it is
    accurate enough: green is where it pays. Hollow: the variant as printed. Labelled: the fastest of each
    response that is accurate enough.
    """
    studies = list(dict.fromkeys(table["study"])) or [""]
    figure = new_figure(PAGE_IN, 4.2)
    axes = figure.subplots(1, len(studies), sharey=True, squeeze=False)[0]
    for ax, study in zip(axes, studies, strict=True):
        logarithmic(ax, x=True, y=True)
        ax.set_title(study.replace("_", " "), loc="left")
        ax.set_xlabel("times as fast as the reference [–]")
        _limits(ax, table[table["study"] == study], table)
    axes[0].set_ylabel("loss: largest error [% of the peak]")
    fitting_legend(figure, _handles(table), "outside lower center")
    letter(axes if len(axes) > 1 else [])
    freeze_layout(figure)
    for ax, study in zip(axes, studies, strict=True):
        _panel(ax, table[table["study"] == study], _shades(table["model"]))
    return figure


def _limits(ax: Axes, rows: pd.DataFrame, table: pd.DataFrame) -> None:
    ratios, errors = rows["times_as_fast"], _heights(table)
    low, high = min([*ratios, 0.5]), max([*ratios, 2.0])
    ax.set_xlim(low / 1.6, high * 2.5)
    ax.set_ylim(min([*errors, ALLOWED_PERCENT / 10.0]) / 3.0, max([*errors, ALLOWED_PERCENT * 10.0]) * 3.0)


def _heights(rows: pd.DataFrame) -> Any:
    return rows["tip_error_percent"].clip(lower=LEAST_PERCENT).to_numpy(dtype=np.float64)


def _panel(ax: Axes, rows: pd.DataFrame, shades: Mapping[str, str]) -> None:
    right, bottom = ax.get_xlim()[1], ax.get_ylim()[0]
    ax.fill_between([1.0, right], bottom, ALLOWED_PERCENT, color=PAYS, zorder=0)
    ax.axvline(1.0, color="#555555", linewidth=0.8, zorder=1)
    ax.axhline(ALLOWED_PERCENT, color="#555555", linewidth=0.8, zorder=1)
    shown = rows[rows["tip_error_percent"].notna()]
    heights = _heights(shown)
    for row, height in zip(shown.to_dict("records"), heights, strict=True):
        shade = shades[row["model"]]
        ax.plot(
            row["times_as_fast"],
            height,
            MARKERS.get(row["response"], "^"),
            color=shade,
            markerfacecolor="white" if row["variant"] == HOLLOW else shade,
            markersize=4.5,
            zorder=3,
        )
    fastest = [_best(of_response) for _, of_response in shown.groupby("response", sort=False)]
    best = [row for row in fastest if row is not None]
    place_labels(
        ax,
        [(row["times_as_fast"], max(row["tip_error_percent"], LEAST_PERCENT)) for row in best],
        [_label(row) for row in best],
        [colour(family(row["model"])) if has_family(row["model"]) else shades[row["model"]] for row in best],
        obstacles=list(zip(shown["times_as_fast"], heights, strict=True)),
    )


def _label(row: "pd.Series[Any]") -> str:
    """In short lines, for a panel is narrow."""
    name = name_of(row["model"]).replace(" (", "\n(")
    return f"{name}\n{row['response']}: {times(row['times_as_fast'])}×"


def _best(rows: pd.DataFrame) -> "pd.Series[Any] | None":
    within = rows[rows["tip_error_percent"] <= ALLOWED_PERCENT]
    return None if within.empty else within.sort_values("times_as_fast").iloc[-1]


def _shades(models: Iterable[str]) -> dict[str, str]:
    """A model's colour in every figure; for forms of the aerodynamics those that no surrogate has."""
    others = cycle(OWN_COLOURS)
    return {model: colour(model) if has_family(model) else next(others) for model in dict.fromkeys(models)}


def _handles(table: pd.DataFrame) -> list[Line2D | Patch]:
    # one entry a colour: those of further sweeps are paler than the model's own
    named: dict[str, str] = {}
    for model, shade in _shades(table["model"]).items():
        is_of_another = has_family(model) and model != family(model)
        named.setdefault(
            shade, f"{label(family(model))}, further sweeps" if is_of_another else name_of(model)
        )
    handles: list[Line2D | Patch] = [
        Line2D([], [], color=shade, marker="o", linestyle="", label=text) for shade, text in named.items()
    ]
    handles += [
        Line2D([], [], color="#555555", marker=MARKERS.get(response, "^"), linestyle="", label=response)
        for response in dict.fromkeys(table["response"])
    ]
    variants = [name for name in VARIANTS if name in set(table["variant"])]
    if len(variants) > 1:
        for variant in variants:
            fill = "white" if variant == HOLLOW else "#555555"
            line = Line2D([], [], color="#555555", marker="o", markerfacecolor=fill, linestyle="")
            line.set_label(VARIANTS[variant])
            handles.append(line)
    handles.append(Patch(color=PAYS, label=f"pays: faster, and within {ALLOWED_PERCENT:g} %"))
    return handles
