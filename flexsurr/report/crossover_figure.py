"""Where a network pays: cost against error of everything that stands for so many modes."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.report.cost_figures import pareto_front
from flexsurr.report.labels import freeze_layout, place_labels
from flexsurr.report.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PAGE_IN,
    fitting_legend,
    letter,
    logarithmic,
    new_figure,
    styled,
)

ALLOWED_PERCENT = 0.1
"""The tip error up to which a surrogate stands for its reference here."""

FAMILIES = {
    "full polynomial": (GREEN, "s"),
    "sparse polynomial": (ORANGE, "D"),
    "network": (BLUE, "o"),
}
"""Colour and marker of each kind of model."""

PANEL_IN = 2.7
LEAST_PERCENT = 1e-6


def family_of(model: str) -> str:
    """Which of `FAMILIES` a model of crossover.csv belongs to."""
    if model.startswith("polynomial"):
        return "sparse polynomial" if model.endswith("_sparse") else "full polynomial"
    return "network"


def cheapest(table: pd.DataFrame, allowed_percent: float = ALLOWED_PERCENT) -> pd.DataFrame:
    """The cheapest row of crossover.csv within an error, for each number of modes and column `family`."""
    rivals = table[table["model"] != "rom"]
    within = rivals[(rivals["tip_error_percent"] <= allowed_percent) & (rivals["diverged"] == 0)]
    named = within.assign(family=within["model"].map(family_of))
    return named.sort_values("wall_s").drop_duplicates(["modes", "family"]).sort_values(["modes", "family"])


@styled
def crossover(table: pd.DataFrame) -> Figure:
    """One panel for each number of modes, cost against error, and one of what the cheapest within 0.1 % cost.

    `table`: the columns of crossover.csv. Cost is relative to the compiled reduced model, whose own error,
    that of the integrator, is the cross. Grey joins what nothing beats in both. A model of which a response
    diverged has no place.
    """
    modes = sorted(table["modes"].unique())
    rows = -(-(len(modes) + 1) // 2)
    figure = new_figure(PAGE_IN, PANEL_IN * rows + 0.4)
    grid = figure.subplots(rows, 2, squeeze=False)
    panels = list(grid.ravel()[: len(modes) + 1])
    for ax in grid.ravel()[len(modes) + 1 :]:
        ax.remove()
    for ax, number in zip(panels, modes, strict=False):
        logarithmic(ax, x=True, y=True)
        ax.set_title(f"{number} modes", loc="left")
        ax.set_xlabel("cost [% of the compiled reduced model]")
        ax.set_ylabel("largest tip error [% of the peak]")
    _against_modes(panels[-1], cheapest(table), modes)
    _legend(figure)
    letter(panels)
    for ax, number in zip(panels, modes, strict=False):
        _limits(ax, table[table["modes"] == number])
    freeze_layout(figure)
    for ax, number in zip(panels, modes, strict=False):
        _panel(ax, table[table["modes"] == number])
    return figure


def _limits(ax: Axes, rows: pd.DataFrame) -> None:
    costs = rows["relative_to_compiled_percent"].dropna()
    errors = rows["tip_error_percent"].dropna().clip(lower=LEAST_PERCENT)
    ax.set_xlim(min(costs.min(), 50.0) / 2.5, max(costs.max(), 100.0) * 2.5)
    ax.set_ylim(min(errors.min(), ALLOWED_PERCENT) / 4.0, max(errors.max(), ALLOWED_PERCENT) * 6.0)


def _panel(ax: Axes, rows: pd.DataFrame) -> None:
    ax.axhline(ALLOWED_PERCENT, color="#555555", linewidth=0.8, zorder=1)
    ax.axvline(100.0, color="#555555", linewidth=0.8, zorder=1)
    shown = rows[(rows["diverged"] == 0) & rows["wall_s"].notna()]
    rivals = shown[shown["model"] != "rom"]
    front = pareto_front(rivals.assign(wall_s_mean=rivals["wall_s"]))
    ax.step(
        front["relative_to_compiled_percent"],
        front["tip_error_percent"].clip(lower=LEAST_PERCENT),
        where="post",
        color="#C9C9C9",
        linewidth=3.0,
        zorder=1,
    )
    points = []
    for row in shown.to_dict("records"):
        shade, marker = (BLACK, "x") if row["model"] == "rom" else FAMILIES[family_of(row["model"])]
        at = row["relative_to_compiled_percent"], max(row["tip_error_percent"], LEAST_PERCENT)
        points.append(at)
        ax.plot(*at, marker, color=shade, markersize=4.2, zorder=3)
    named = [row for row in front.to_dict("records") if row["tip_error_percent"] <= 10.0 * ALLOWED_PERCENT]
    place_labels(
        ax,
        [
            (row["relative_to_compiled_percent"], max(row["tip_error_percent"], LEAST_PERCENT))
            for row in named
        ],
        [row["model"].replace("_", " ") for row in named],
        [FAMILIES[family_of(row["model"])][0] for row in named],
        obstacles=points,
    )


def _against_modes(ax: Axes, best: pd.DataFrame, modes: list[int]) -> None:
    logarithmic(ax, y=True)
    costs = np.array([*best["relative_to_compiled_percent"], 100.0])
    ax.set_ylim(costs.min() / 2.0, costs.max() * 2.0)
    ax.axhline(100.0, color="#555555", linewidth=0.8, zorder=1)
    for family, (shade, marker) in FAMILIES.items():
        of_family = best[best["family"] == family].set_index("modes")["relative_to_compiled_percent"]
        # a number of modes at which no model of the family is within breaks its line
        ax.plot(modes, of_family.reindex(modes), marker=marker, color=shade, zorder=3)
    ax.set_title(f"The cheapest within {ALLOWED_PERCENT:g} %", loc="left")
    ax.set_xlabel("modes r [–]")
    ax.set_ylabel("cost [% of the compiled reduced model]")
    ax.set_xticks(modes)


def _legend(figure: Figure) -> None:
    handles = [
        Line2D([], [], color=shade, marker=marker, linestyle="", label=name)
        for name, (shade, marker) in FAMILIES.items()
    ]
    handles.append(
        Line2D(
            [],
            [],
            color=BLACK,
            marker="x",
            linestyle="",
            label="reduced order, compiled: the integrator's error",
        )
    )
    handles.append(Line2D([], [], color="#C9C9C9", linewidth=3.0, label="Pareto front"))
    fitting_legend(figure, handles, "outside upper center")
