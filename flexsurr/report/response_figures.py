"""Time histories of surrogates beside the model they stand for: Figs. 10 and 12 of the study."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexsurr.report.style import (
    BLACK,
    PAGE_IN,
    VARIANTS,
    colour,
    dashes,
    label,
    letter,
    logarithmic,
    new_figure,
    styled,
)

WINDOW_S = 0.6
"""Length of a window in which single oscillations can be seen."""

LOADED = "#F6E7C8"

# What rounding leaves is no error to compare.
SMALLEST_PERCENT = 1e-9


@styled
def figure_10(response: pd.DataFrame) -> Figure:
    """Free response: the first and the last oscillations, and the tip error over the whole of it.

    `response`: columns variant, model ("reference" or a surrogate's), t_s, tip_z_m, tip_error_percent,
    load_end_s; one simulation a variant. One column of panels for each variant.
    """
    return _histories(response, forced=False)


@styled
def figure_12(response: pd.DataFrame) -> Figure:
    """Forced response: the end of the load, the last oscillations, and the tip error over the whole.

    The interval in which the tip force acts is shaded. Columns as in `figure_10`.
    """
    return _histories(response, forced=True)


def _histories(response: pd.DataFrame, forced: bool) -> Figure:
    variants = [variant for variant in VARIANTS if variant in set(response["variant"])]
    figure = new_figure(PAGE_IN, 5.0)
    grid = figure.subplots(3, len(variants), sharey="row", squeeze=False)
    for column, variant in zip(grid.T, variants, strict=True):
        shown = response[response["variant"] == variant]
        reference = shown[shown["model"] == "reference"]
        end_s, load_end_s = float(reference["t_s"].max()), float(shown["load_end_s"].iloc[0])
        first_s = max(0.0, load_end_s - 0.55 * WINDOW_S) if forced else 0.0
        for ax, start_s in ((column[0], first_s), (column[1], max(0.0, end_s - WINDOW_S))):
            _window(ax, shown, start_s, min(start_s + WINDOW_S, end_s))
        _errors(column[2], shown, end_s)
        if forced:
            for ax in column:
                ax.axvspan(0.0, load_end_s, color=LOADED, linewidth=0, zorder=0)
        column[0].set_title(VARIANTS[variant], loc="left")
    for ax in grid[:2, 0]:
        ax.set_ylabel("tip height z [m]")
    grid[2, 0].set_ylabel("tip error [% of the peak]")
    if forced:
        # the axes clip the span to their own window
        grid[0, 0].annotate(
            "force acts", (0.02, 0.04), xycoords="axes fraction", fontsize=7, color="#8A6A1F", ha="left"
        )
    lines = {line.get_label(): line for line in grid[0, 0].get_lines()}
    figure.legend(lines.values(), lines.keys(), loc="outside upper center", ncols=len(lines))
    letter(grid.ravel())
    return figure


def _window(ax: Axes, shown: pd.DataFrame, start_s: float, end_s: float) -> None:
    """Tip height of every model between two times."""
    for model in _models(shown):
        part = shown[(shown["model"] == model) & shown["t_s"].between(start_s, end_s)]
        reference = model == "reference"
        ax.plot(
            part["t_s"],
            part["tip_z_m"],
            color="#B8B8B8" if reference else colour(model),
            linestyle="-" if reference else dashes(model),
            linewidth=3.0 if reference else 1.1,
            label=label(model),
            zorder=1 if reference else 2,
        )
    ax.set(xlim=(start_s, end_s), xlabel="time [s]")


def _errors(ax: Axes, shown: pd.DataFrame, end_s: float) -> None:
    """The largest tip error so far, of every surrogate, on a logarithmic scale."""
    for model in _models(shown)[1:]:
        part = shown[(shown["model"] == model) & (shown["t_s"] > 0.0)]
        worst = np.maximum.accumulate(np.maximum(part["tip_error_percent"], SMALLEST_PERCENT))
        ax.plot(part["t_s"], worst, color=colour(model), linestyle=dashes(model))
        if part["t_s"].max() < end_s:
            ax.plot(part["t_s"].iloc[-1], worst.iloc[-1], "x", color=BLACK, markersize=5)
    logarithmic(ax, y=True)
    ax.set(xlim=(0.0, end_s), xlabel="time [s]")


def _models(shown: pd.DataFrame) -> Sequence[str]:
    """The models in order of appearance, the reference first."""
    return ["reference", *(model for model in shown["model"].unique() if model != "reference")]
