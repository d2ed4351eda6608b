"""Responses of every model of a study at once, and how far each has strayed."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexsurr.config.structure import Structure
from flexsurr.report.curves import curve, each, follow_reference, legend, shade, variants_in
from flexsurr.report.style import BLACK, PAGE_IN, VARIANTS, letter, logarithmic, new_figure, styled

WINDOW_S = 0.6
"""Length of a window in which single oscillations of an undamped structure can be seen."""

TIP = {"tip_z_m": "tip z [m]", "tip_y_m": "tip y [m]", "tip_x_m": "tip x [m]"}
"""The tip's coordinates, and what their axes are called."""

STILL_M = 1e-9
"""Less is no motion."""

SMALLEST_PERCENT = 1e-9
"""What rounding leaves is no error to compare."""


@styled
def free_response_of_every_model(structure: Structure, response: pd.DataFrame) -> Figure:
    """The tip of every model in one free response, as it moves furthest, and the largest tip error so far.

    `response`: columns variant, model ("reference" or a surrogate's), t_s, tip_x_m, tip_y_m, tip_z_m,
    tip_twist_rad, tip_error_percent, load_end_s; one simulation a variant. One column of panels for each
    variant. A structure that comes to rest is shown whole; of any other the first and the last oscillations.
    """
    return _histories(structure, response)


@styled
def forced_response_of_every_model(structure: Structure, response: pd.DataFrame) -> Figure:
    """The same from rest under the study's load until a random time; where it acts is shaded."""
    return _histories(structure, response)


def _histories(structure: Structure, response: pd.DataFrame) -> Figure:
    variants = variants_in(response)
    response, motion = _moving(response)
    heights = 1 if structure.dissipates else 2
    figure = new_figure(PAGE_IN, 2.4 + 1.4 * heights + 0.03 * response["model"].nunique())
    grid = figure.subplots(heights + 1, len(variants), sharey="row", squeeze=False)
    for column, variant in zip(grid.T, variants, strict=True):
        shown = response[response["variant"] == variant]
        windows = _windows(structure, shown)
        for ax, (start_s, end_s, title) in zip(column, windows, strict=False):
            for model, part in each(shown[shown["t_s"].between(start_s, end_s)]):
                curve(ax, part["t_s"], part["moving"], model)
            ax.set(xlim=(start_s, end_s))
            ax.set_title(f"{title}, {VARIANTS[variant]}" if ax is column[0] else title, loc="left")
        _errors(column[-1], shown)
        for ax in column:
            limits = ax.get_xlim()
            shade(ax, float(shown["load_end_s"].max()))
            ax.set(xlim=limits, xlabel="time [s]")
    for row in grid[:-1]:
        row[0].set_ylabel(motion)
        follow_reference(row[0], response.loc[response["model"] == "reference", "moving"])
    grid[-1, 0].set_ylabel("tip error [% of the peak]")
    legend(figure, grid[0], shaded=bool((response["load_end_s"] > 0.0).any()))
    letter(grid.ravel())
    return figure


def _moving(response: pd.DataFrame) -> tuple[pd.DataFrame, str]:
    """`response` with a column `moving`, the coordinate of the tip that moves furthest, and its label.

    The twist where the tip stays where it is: of a rod that only twists.
    """
    tip = response.loc[response["model"] == "reference", list(TIP)]
    ways = tip.max() - tip.min()
    if ways.max() > STILL_M:
        axis = str(ways.idxmax())
        return response.assign(moving=response[axis]), TIP[axis]
    return response.assign(moving=np.rad2deg(response["tip_twist_rad"])), "tip twist [deg]"


def _windows(structure: Structure, shown: pd.DataFrame) -> list[tuple[float, float, str]]:
    """Start and end [s] of the panels of the tip, and what they show."""
    end_s, load_end_s = float(shown["t_s"].max()), float(shown["load_end_s"].max())
    if structure.dissipates:
        return [(0.0, end_s, "tip")]
    first_s = max(0.0, min(load_end_s - 0.55 * WINDOW_S, end_s - WINDOW_S))
    first = "end of the load" if load_end_s > 0.0 else "first oscillations"
    return [
        (first_s, min(first_s + WINDOW_S, end_s), first),
        (max(0.0, end_s - WINDOW_S), end_s, "last oscillations"),
    ]


def _errors(ax: Axes, shown: pd.DataFrame) -> None:
    """The largest tip error so far, of every surrogate, on a logarithmic scale; a cross where one failed."""
    end_s = float(shown["t_s"].max())
    for model, part in each(shown[shown["model"] != "reference"]):
        part = part[part["t_s"] > 0.0]
        if part.empty:
            continue
        worst = part["tip_error_percent"].clip(lower=SMALLEST_PERCENT).cummax()
        curve(ax, part["t_s"], worst, model)
        if part["t_s"].iloc[-1] < end_s:
            ax.plot(part["t_s"].iloc[-1], worst.iloc[-1], "x", color=BLACK, markersize=5)
    logarithmic(ax, y=True)
    ax.set_xlim(0.0, end_s)
    ax.set_title("largest error so far", loc="left")
