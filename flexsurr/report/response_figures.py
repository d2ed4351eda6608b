"""Time histories of surrogates beside the model they stand for: Figs. 10 and 12 of the study."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from flexsurr.report.style import (
    BLACK,
    LOADED,
    PAGE_IN,
    VARIANTS,
    colour,
    label,
    letter,
    logarithmic,
    new_figure,
    styled,
)

WINDOW_S = 0.6
"""Length of a window in which single oscillations can be seen."""

MARKED_EVERY_S = 0.045
_MARKERS = ("s", "o", "^", "D", "v", "P")

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
    models = _models(response)
    for column, variant in zip(grid.T, variants, strict=True):
        shown = response[response["variant"] == variant]
        reference = shown[shown["model"] == "reference"]
        end_s, load_end_s = float(reference["t_s"].max()), float(shown["load_end_s"].iloc[0])
        first_s = max(0.0, load_end_s - 0.55 * WINDOW_S) if forced else 0.0
        for ax, start_s in ((column[0], first_s), (column[1], max(0.0, end_s - WINDOW_S))):
            _window(ax, shown, models, start_s, min(start_s + WINDOW_S, end_s))
        _errors(column[2], shown, models, end_s)
        if forced:
            for ax in column:
                ax.axvspan(0.0, load_end_s, color=LOADED, linewidth=0, zorder=0)
        first = "end of the force" if forced else "first oscillations"
        titles = (f"{first}, {VARIANTS[variant]}", "last oscillations", "largest error so far")
        for ax, title in zip(column, titles, strict=True):
            ax.set_title(title, loc="left")
    for ax in grid[:2, 0]:
        ax.set_ylabel("tip height z [m]")
    grid[2, 0].set_ylabel("tip error [% of the peak]")
    handles = [
        Line2D([], [], color=colour(model), marker=_marker(k), markerfacecolor="white", label=label(model))
        for k, model in enumerate(models)
    ]
    shade = [Patch(color=LOADED, label="force acts")] if forced else []
    figure.legend(handles=[*handles, *shade], loc="outside upper center", ncols=len(handles) + len(shade))
    letter(grid.ravel())
    return figure


def _window(ax: Axes, shown: pd.DataFrame, models: Sequence[str], start_s: float, end_s: float) -> None:
    """Tip height of every model between two times.

    The reference lies over the surrogates' lines and under their markers, which take turns: a model
    that coincides with it still shows its markers, one that strays its line.
    """
    for k, model in enumerate(models):
        part = shown[(shown["model"] == model) & shown["t_s"].between(start_s, end_s)]
        t, z = part["t_s"].to_numpy(), part["tip_z_m"].to_numpy()
        reference = model == "reference"
        ax.plot(t, z, color=colour(model), linewidth=1.0 if reference else 0.8, zorder=3 if reference else 2)
        if not reference:
            times = np.arange(start_s + k * MARKED_EVERY_S / len(models), end_s, MARKED_EVERY_S)
            at = np.unique(np.clip(np.searchsorted(t, times), 0, max(t.size - 1, 0)))[: t.size]
            ax.plot(
                t[at],
                z[at],
                _marker(k),
                color=colour(model),
                markerfacecolor="white",
                markersize=3.6,
                markeredgewidth=0.9,
                zorder=4,
            )
    ax.set(xlim=(start_s, end_s), xlabel="time [s]")


def _errors(ax: Axes, shown: pd.DataFrame, models: Sequence[str], end_s: float) -> None:
    """The largest tip error so far, of every surrogate, on a logarithmic scale."""
    for k, model in enumerate(models[1:], start=1):
        part = shown[(shown["model"] == model) & (shown["t_s"] > 0.0)]
        if part.empty:
            continue
        t = part["t_s"].to_numpy()
        worst = np.maximum.accumulate(np.maximum(part["tip_error_percent"].to_numpy(), SMALLEST_PERCENT))
        times = end_s * (np.arange(6) + k / len(models)) / 6.0
        marked = np.searchsorted(t, times[times < t[-1]])
        ax.plot(
            t,
            worst,
            marker=_marker(k),
            color=colour(model),
            markerfacecolor="white",
            markersize=3.6,
            markevery=list(marked),
        )
        if t[-1] < end_s:
            ax.plot(t[-1], worst[-1], "x", color=BLACK, markersize=5)
    logarithmic(ax, y=True)
    ax.set(xlim=(0.0, end_s), xlabel="time [s]")


def _models(response: pd.DataFrame) -> Sequence[str]:
    """The models by name, the reference first: the same order, and so the same markers, in every panel."""
    return ["reference", *sorted(set(response["model"]) - {"reference"})]


def _marker(k: int) -> str:
    """The marker of the k-th model; none for the reference, which is the first."""
    return _MARKERS[(k - 1) % len(_MARKERS)] if k else ""
