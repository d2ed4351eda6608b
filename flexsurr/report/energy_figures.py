"""Total energy along free responses: Fig. 13 of the study."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexsurr.report.integrators import integrator_colour, integrator_name
from flexsurr.report.style import (
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

# What rounding leaves is no drift to compare.
SMALLEST_PERCENT = 1e-12

ENERGY_SHOWN_S = 0.6
"""Length of the window in which the energy's oscillation within a period can be seen."""


@styled
def figure_13(energy: pd.DataFrame) -> Figure:
    """The reference's exact energy along the response of each model, and of each integrator.

    `energy`: columns panel ("models", "integrators"), variant, model, integrator, t_s, energy_J,
    drift_percent. Models are integrated without drift; integrators run the exact field. One column of
    panels for each variant. The drift drawn is the largest so far.
    """
    variants = [variant for variant in VARIANTS if variant in set(energy["variant"])]
    figure = new_figure(PAGE_IN, 5.6)
    grid = figure.subplots(3, len(variants), sharey="row", squeeze=False, height_ratios=(0.8, 1, 1.25))
    for column, variant in zip(grid.T, variants, strict=True):
        shown = energy[energy["variant"] == variant]
        models = shown[shown["panel"] == "models"]
        _energies(column[0], models)
        for model, part in _each(models, "model"):
            _drift(column[1], part, colour(model), dashes(model), label(model))
        for integrator, part in _each(shown[shown["panel"] == "integrators"], "integrator"):
            line, style = integrator_colour(integrator)
            _drift(column[2], part, line, style, integrator_name(integrator))
        titles = (VARIANTS[variant], "models, an integrator without drift", "integrators, the exact field")
        for ax, title in zip(column, titles, strict=True):
            ax.set_title(title, loc="left")
    for ax, text in zip(grid[:, 0], ("energy [J]", "energy drift [%]", "energy drift [%]"), strict=True):
        ax.set_ylabel(text)
    for ax in grid[0]:
        ax.set_xlabel("time [s]")
    lines, names = grid[1, 0].get_legend_handles_labels()
    figure.legend(lines, names, loc="outside upper center", ncols=len(names))
    lines, names = grid[2, 0].get_legend_handles_labels()
    figure.legend(
        lines, names, loc="outside lower center", ncols=3, title="integrators on the exact field, bottom row"
    )
    letter(grid.ravel())
    return figure


def _energies(ax: Axes, models: pd.DataFrame) -> None:
    """Energy against time over the first oscillations."""
    for model, part in _each(models, "model"):
        part = part[part["t_s"] <= ENERGY_SHOWN_S]
        ax.plot(part["t_s"], part["energy_J"], color=colour(model), linestyle=dashes(model))
    ax.margins(x=0.0)


def _drift(ax: Axes, part: pd.DataFrame, line: str, style: object, name: str) -> None:
    """The largest drift so far, on a logarithmic scale."""
    part = part[part["t_s"] > 0.0]
    worst = np.maximum.accumulate(np.maximum(part["drift_percent"], SMALLEST_PERCENT))
    ax.plot(part["t_s"], worst, color=line, linestyle=style, label=name)
    logarithmic(ax, y=True)
    ax.margins(x=0.0)
    ax.set_xlabel("time [s]")


def _each(frame: pd.DataFrame, column: str) -> list[tuple[str, pd.DataFrame]]:
    """The rows of each value of a column, in order of appearance."""
    return [(str(value), part) for value, part in frame.groupby(column, sort=False)]
