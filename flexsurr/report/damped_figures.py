"""Responses and energies of a damped structure that twists: Figs. 14 and 15 of the study, and energy."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from flexsurr.report.style import (
    LOADED,
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

SMALLEST_PERCENT = 1e-9
"""What rounding leaves is no error to compare."""

SHOWN_BEYOND = 0.35
"""How far beyond the reference's range the axes go, as a share of it: a model that leaves it is cut off."""

DECADES = 8
"""Decades of energy below the largest that are shown."""


@styled
def figure_14(response: pd.DataFrame) -> Figure:
    """Free response: tip height, twist of the tip, and the tip error so far, of every model.

    `response`: columns variant, model ("reference" or a surrogate's), t_s, tip_z_m, tip_twist_rad,
    tip_error_percent, load_end_s; one simulation a variant. One column of panels for each variant.
    """
    return _histories(response)


@styled
def figure_15(response: pd.DataFrame) -> Figure:
    """Forced response, from rest; where the load acts is shaded. Columns as in `figure_14`."""
    return _histories(response)


@styled
def energy_decay(energy: pd.DataFrame) -> Figure:
    """The reference's exact energy along the free and the forced response of each model.

    `energy`: columns panel, variant, response, model, t_s, energy_J, load_end_s. Only the loads put energy
    in and the dampers take it out: with no load no curve may rise.
    """
    models = energy[energy["panel"] == "models"]
    variants = [variant for variant in VARIANTS if variant in set(models["variant"])]
    figure = new_figure(PAGE_IN, 4.6)
    grid = figure.subplots(2, len(variants), sharey="row", squeeze=False)
    for row, response in zip(grid, ("free", "forced"), strict=True):
        for ax, variant in zip(row, variants, strict=True):
            shown = models[(models["variant"] == variant) & (models["response"] == response)]
            largest = shown.loc[shown["model"] == "rom", "energy_J"].max()
            for model, part in _each(shown):
                _line(ax, part["t_s"], part["energy_J"].clip(lower=1e-3 * largest * 10.0**-DECADES), model)
            logarithmic(ax, y=True)
            ax.set_ylim(largest * 10.0**-DECADES, 30.0 * largest)
            _shade(ax, shown)
            ax.set_title(f"{response} response, {VARIANTS[variant]}", loc="left")
            ax.margins(x=0.0)
        row[0].set_ylabel("energy [J]")
    for ax in grid[-1]:
        ax.set_xlabel("time [s]")
    _legend(figure, grid[0, 0], shaded=True)
    letter(grid.ravel())
    return figure


def _histories(response: pd.DataFrame) -> Figure:
    variants = [variant for variant in VARIANTS if variant in set(response["variant"])]
    figure = new_figure(PAGE_IN, 5.4)
    grid = figure.subplots(3, len(variants), sharex=True, sharey="row", squeeze=False)
    response = response.assign(twist_deg=np.rad2deg(response["tip_twist_rad"]))
    for column, variant in zip(grid.T, variants, strict=True):
        shown = response[response["variant"] == variant]
        _history(column[0], shown, "tip_z_m")
        _history(column[1], shown, "twist_deg")
        for model, part in _each(shown):
            if model != "reference":
                worst = part["tip_error_percent"].clip(lower=SMALLEST_PERCENT).cummax()
                _line(column[2], part["t_s"].iloc[1:], worst.iloc[1:], model)
        logarithmic(column[2], y=True)
        titles = (f"tip height, {VARIANTS[variant]}", "twist of the tip", "largest error so far")
        for ax, title in zip(column, titles, strict=True):
            _shade(ax, shown)
            ax.margins(x=0.0)
            ax.set_title(title, loc="left")
        column[2].set_xlabel("time [s]")
    for ax, text in zip(
        grid[:, 0], ("tip height z [m]", "twist [deg]", "tip error [% of the peak]"), strict=True
    ):
        ax.set_ylabel(text)
    _legend(figure, grid[0, 0], shaded=bool((response["load_end_s"] > 0.0).any()))
    letter(grid.ravel())
    return figure


def _history(ax: Axes, shown: pd.DataFrame, column: str) -> None:
    """One quantity against time, of every model; the axes follow the reference."""
    for model, part in _each(shown):
        _line(ax, part["t_s"], part[column], model)
    reference = shown.loc[shown["model"] == "reference", column]
    low, high = min(reference.min(), 0.0), max(reference.max(), 0.0)
    beyond = SHOWN_BEYOND * max(high - low, 1e-12)
    below, above = ax.get_ylim() if ax.dataLim.height == 0.0 else (low - beyond, high + beyond)
    ax.set_ylim(below, above)


def _line(ax: Axes, t: pd.Series, values: pd.Series, model: str) -> None:
    truth = model in ("reference", "rom")
    ax.plot(
        t,
        values,
        color=colour(model),
        linestyle="-" if truth else dashes(model),
        linewidth=1.7 if truth else 1.0,
        alpha=0.45 if truth else 1.0,
        label=label(model),
        zorder=2 if truth else 3,
    )


def _shade(ax: Axes, shown: pd.DataFrame) -> None:
    load_end_s = float(shown["load_end_s"].max())
    if load_end_s > 0.0:
        ax.axvspan(0.0, load_end_s, color=LOADED, linewidth=0, zorder=0)


def _legend(figure: Figure, ax: Axes, shaded: bool) -> None:
    handles, names = ax.get_legend_handles_labels()
    if shaded:
        handles, names = [*handles, Patch(color=LOADED)], [*names, "load acts"]
    figure.legend(handles, names, loc="outside upper center", ncols=min(len(names), 5))


def _each(frame: pd.DataFrame) -> Sequence[tuple[str, pd.DataFrame]]:
    """The rows of each model, in order of appearance."""
    return [(str(model), part) for model, part in frame.groupby("model", sort=False)]
