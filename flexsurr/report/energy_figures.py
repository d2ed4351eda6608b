"""Total energy along responses: Fig. 13 of the paper, its drift, and its decay where there are dampers."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

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
    PAGE_IN,
    VARIANTS,
    colour,
    dashes,
    integrator_colour,
    integrator_name,
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

DECADES = 8
"""Decades of energy below the largest that are shown."""


@styled
def figure_13(energy: pd.DataFrame) -> Figure:
    """The reference's exact energy along the forced response of reference, HNN and MLP.

    `energy`: columns panel ("models", "integrators"), variant, response, model, integrator, t_s, energy_J,
    drift_percent, load_end_s. The load acts in the shaded interval. One panel for each variant.
    """
    forced = energy[(energy["panel"] == "models") & (energy["response"] == "forced")]
    variants = variants_in(forced)
    figure = new_figure(PAGE_IN, 1.1 + 1.9 * len(variants))
    axes = figure.subplots(len(variants), 1, sharex=True, squeeze=False)[:, 0]
    for ax, variant in zip(axes, variants, strict=True):
        shown = the_papers(forced[forced["variant"] == variant], ("mlp", "hnn"))
        papers_curves(ax, shown, "energy_J")
        shade(ax, float(shown["load_end_s"].max()))
        follow_reference(ax, shown.loc[shown["model"] == "rom", "energy_J"])
        ax.set_ylim(bottom=0.0)
        ax.set_ylabel("energy [J]")
        ax.margins(x=0.0)
        ax.set_title(VARIANTS[variant], loc="left")
    axes[-1].set_xlabel("time [s]")
    legend(figure, axes, shaded=True)
    letter(axes)
    return figure


@styled
def energy_drift(energy: pd.DataFrame) -> Figure:
    """Drift of the reference's exact energy in a free response, of each model and of each integrator.

    Columns as in `figure_13`. Models are integrated without drift; integrators run the exact field. One
    column of panels for each variant. The drift drawn is the largest so far.
    """
    energy = energy[energy["response"] == "free"]
    variants = variants_in(energy)
    figure = new_figure(PAGE_IN, 5.6)
    grid = figure.subplots(3, len(variants), sharey="row", squeeze=False, height_ratios=(0.8, 1, 1.25))
    for column, variant in zip(grid.T, variants, strict=True):
        shown = energy[energy["variant"] == variant]
        models = shown[shown["panel"] == "models"]
        _energies(column[0], models)
        for model, part in each(models):
            _drift(column[1], part, colour(model), dashes(model), label(model))
        for integrator, part in each(shown[shown["panel"] == "integrators"], "integrator"):
            line, style = integrator_colour(integrator)
            _drift(column[2], part, line, style, integrator_name(integrator))
        titles = (VARIANTS[variant], "models, an integrator without drift", "integrators, the exact field")
        for ax, title in zip(column, titles, strict=True):
            ax.set_title(title, loc="left")
    for ax, text in zip(grid[:, 0], ("energy [J]", "energy drift [%]", "energy drift [%]"), strict=True):
        ax.set_ylabel(text)
    for ax in grid[0]:
        ax.set_xlabel("time [s]")
    legend(figure, grid[1], shaded=False)
    lines, names = grid[2, 0].get_legend_handles_labels()
    figure.legend(
        lines, names, loc="outside lower center", ncols=3, title="integrators on the exact field, bottom row"
    )
    letter(grid.ravel())
    return figure


@styled
def energy_decay(energy: pd.DataFrame) -> Figure:
    """The reference's exact energy along the free and the forced response of each model; as `figure_13`.

    Only the loads put energy in and the dampers take it out: with no load no curve may rise.
    """
    models = energy[energy["panel"] == "models"]
    variants = variants_in(models)
    figure = new_figure(PAGE_IN, 4.6)
    grid = figure.subplots(2, len(variants), sharey="row", squeeze=False)
    for row, response in zip(grid, ("free", "forced"), strict=True):
        for ax, variant in zip(row, variants, strict=True):
            shown = models[(models["variant"] == variant) & (models["response"] == response)]
            largest = shown.loc[shown["model"] == "rom", "energy_J"].max()
            for model, part in each(shown):
                curve(ax, part["t_s"], part["energy_J"].clip(lower=1e-3 * largest * 10.0**-DECADES), model)
            logarithmic(ax, y=True)
            ax.set_ylim(largest * 10.0**-DECADES, 30.0 * largest)
            shade(ax, float(shown["load_end_s"].max()))
            ax.set_title(f"{response} response, {VARIANTS[variant]}", loc="left")
            ax.margins(x=0.0)
        row[0].set_ylabel("energy [J]")
    for ax in grid[-1]:
        ax.set_xlabel("time [s]")
    legend(figure, grid[0], shaded=True)
    letter(grid.ravel())
    return figure


def _energies(ax: Axes, models: pd.DataFrame) -> None:
    """Energy against time over the first oscillations."""
    for model, part in each(models):
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
