"""Responses against time: Figs. 10, 12, 14 and 15, those of every model, one of a person's own, rollouts."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexsurr.config.structure import Structure
from flexsurr.report.curves import (
    curve,
    each,
    follow_reference,
    legend,
    papers_curves,
    shade,
    the_papers,
    variants_in,
)
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

CANTILEVER_S = 2.0
"""What Figs. 10 and 12 show, by the paper's text."""

WING_S = 10.0
"""What our Figs. 14 and 15 show; the paper's text does not say what its own do."""

LABELS = {
    "tip_x_m": "tip x [m]",
    "tip_y_m": "tip y [m]",
    "tip_z_m": "tip z [m]",
    "tip_twist_deg": "tip twist [deg]",
}
CANTILEVERS_TIP = ("tip_x_m", "tip_z_m")


@styled
def figure_10(response: pd.DataFrame) -> Figure:
    """The first 2 s of a free response of the cantilever: tip x and z of reference, HNN and MLP.

    `response`: columns variant, model ("reference" or a surrogate's), t_s, tip_x_m, tip_y_m, tip_z_m,
    tip_twist_rad, load_end_s; one simulation a variant. One column of panels for each variant.
    """
    return _histories(response, ("hnn", "mlp"), CANTILEVERS_TIP, CANTILEVER_S)


@styled
def figure_12(response: pd.DataFrame) -> Figure:
    """The first 2 s under a load that acts throughout: as `figure_10`."""
    return _histories(response, ("hnn", "mlp"), CANTILEVERS_TIP, CANTILEVER_S)


@styled
def figure_14(response: pd.DataFrame) -> Figure:
    """A free response of the wing: tip x, y, z and twist of reference, D-HNN and MLP. As `figure_10`."""
    return _histories(response, ("dissipative_hnn", "mlp"), tuple(LABELS), WING_S)


@styled
def figure_15(response: pd.DataFrame) -> Figure:
    """The wing from rest under the loads of eqs. 13 and 14 for 5 s: as `figure_14`."""
    return _histories(response, ("dissipative_hnn", "mlp"), tuple(LABELS), WING_S)


def _histories(
    response: pd.DataFrame, architectures: tuple[str, ...], quantities: tuple[str, ...], until_s: float
) -> Figure:
    """One row of panels for each of `quantities`, one column for each variant, to `until_s` [s]."""
    variants = variants_in(response)
    response = response[response["t_s"] <= until_s]
    response = response.assign(tip_twist_deg=np.rad2deg(response["tip_twist_rad"]))
    figure = new_figure(PAGE_IN, 0.7 + 1.5 * len(quantities))
    grid = figure.subplots(len(quantities), len(variants), sharex=True, sharey="row", squeeze=False)
    for column, variant in zip(grid.T, variants, strict=True):
        shown = the_papers(response[response["variant"] == variant], architectures)
        load_end_s = float(shown["load_end_s"].max())
        for ax, quantity in zip(column, quantities, strict=True):
            papers_curves(ax, shown, quantity)
            shade(ax, load_end_s)
            ax.margins(x=0.0)
        column[0].set_title(VARIANTS[variant], loc="left")
        column[-1].set_xlabel("time [s]")
    for row, quantity in zip(grid, quantities, strict=True):
        row[0].set_ylabel(LABELS[quantity])
        follow_reference(row[0], response.loc[response["model"] == "reference", quantity])
    legend(figure, grid[0], shaded=bool((response["load_end_s"] > 0.0).any()))
    letter(grid.ravel())
    return figure


@styled
def response_plot(response: pd.DataFrame, title: str) -> Figure:
    """Tip and twist over time, those that move, or every state where there is no tip.

    `response`: columns t_s and either tip_x_m, tip_y_m, tip_z_m, tip_twist_rad or states by their names.
    """
    if "tip_x_m" in response:
        shown = response.assign(tip_twist_deg=np.rad2deg(np.unwrap(response["tip_twist_rad"])))[list(LABELS)]
        shown = shown.loc[:, shown.max() - shown.min() > 0.0] if len(shown) > 1 else shown
    else:
        shown = response.drop(columns=["t_s", "energy_J"], errors="ignore")
    figure = new_figure(PAGE_IN, 0.7 + 1.5 * shown.shape[1])
    axes = figure.subplots(shown.shape[1], 1, sharex=True, squeeze=False)[:, 0]
    for ax, name in zip(axes, shown, strict=True):
        ax.plot(response["t_s"], shown[name])
        ax.set_ylabel(LABELS.get(str(name), str(name)))
        ax.margins(x=0.0)
    axes[0].set_title(title, loc="left")
    axes[-1].set_xlabel("time [s]")
    return figure


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
    return _of_every_model(structure, response)


@styled
def forced_response_of_every_model(structure: Structure, response: pd.DataFrame) -> Figure:
    """The same from rest under the study's load until a random time; where it acts is shaded."""
    return _of_every_model(structure, response)


def _of_every_model(structure: Structure, response: pd.DataFrame) -> Figure:
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
    ends = 0.0 < load_end_s < end_s
    first_s = max(0.0, min(load_end_s - 0.55 * WINDOW_S, end_s - WINDOW_S)) if ends else 0.0
    first = "end of the load" if ends else "first oscillations"
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


DATA = "data"


@styled
def rollouts(curves: pd.DataFrame) -> Figure:
    """States against time: the samples of held-out trajectories, and surrogates that start with the first.

    `curves`: columns trajectory, model ("data" or a surrogate's), state, unit, t_s, value. One column of
    panels for each trajectory, one row for each state.
    """
    trajectories, states = each(curves, "trajectory"), list(dict.fromkeys(curves["state"]))
    figure = new_figure(PAGE_IN, 0.7 + 1.4 * len(states))
    grid = figure.subplots(len(states), len(trajectories), sharex="col", sharey="row", squeeze=False)
    for column, (number, of_one) in zip(grid.T, trajectories, strict=True):
        for ax, state in zip(column, states, strict=True):
            for model, part in each(of_one[of_one["state"] == state]):
                _curve(ax, part["t_s"], part["value"], model)
        column[0].set_title(f"trajectory {number}", loc="left")
        column[-1].set_xlabel("time [s]")
    for row, state in zip(grid, states, strict=True):
        of_state = curves[curves["state"] == state]
        row[0].set_ylabel(f"{state} [{of_state['unit'].iloc[0]}]")
        follow_reference(row[0], of_state.loc[of_state["model"] == DATA, "value"])
    legend(figure, grid[0], shaded=False)
    letter(grid.ravel())
    return figure


@styled
def phase_plane(curves: pd.DataFrame) -> Figure:
    """The same, the first half's first state against the second half's: q against p of the first pair."""
    trajectories, states = each(curves, "trajectory"), list(dict.fromkeys(curves["state"]))
    q, p = states[0], states[len(states) // 2]
    units = dict(zip(curves["state"], curves["unit"], strict=True))
    figure = new_figure(PAGE_IN, 0.7 + PAGE_IN / max(len(trajectories), 2))
    axes = figure.subplots(1, len(trajectories), sharex=True, sharey=True, squeeze=False)[0]
    for ax, (number, of_one) in zip(axes, trajectories, strict=True):
        for model, part in each(of_one):
            along = {state: rows["value"] for state, rows in each(part, "state")}
            _curve(ax, along[q], along[p], model)
        ax.set_title(f"trajectory {number}", loc="left")
        ax.set_xlabel(f"{q} [{units[q]}]")
    axes[0].set_ylabel(f"{p} [{units[p]}]")
    data = curves[curves["model"] == DATA]
    follow_reference(axes[0], data.loc[data["state"] == p, "value"])
    low, high = data.loc[data["state"] == q, "value"].agg(["min", "max"])
    axes[0].set_xlim(low - 0.25 * (high - low), high + 0.25 * (high - low))
    legend(figure, axes, shaded=False)
    letter(axes)
    return figure


def _curve(ax: Axes, x: pd.Series, y: pd.Series, model: str) -> None:
    if model == DATA:
        ax.plot(x, y, ".", color=BLACK, markersize=3, alpha=0.6, label=label(model), zorder=2)
    else:
        ax.plot(
            x, y, color=colour(model), linestyle=dashes(model), linewidth=1.0, label=label(model), zorder=3
        )
