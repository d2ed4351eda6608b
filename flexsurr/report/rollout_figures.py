"""Surrogates beside recorded trajectories: against time, and in the phase plane."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexsurr.report.curves import each, follow_reference, legend
from flexsurr.report.style import BLACK, PAGE_IN, colour, dashes, label, letter, new_figure, styled

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
