"""Full and reduced order against exact statics and against each other: Figs. 8 and 9 of the paper."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.report.curves import each, legend, variants_in
from flexsurr.report.style import (
    COLOURS,
    GREY,
    NAMES,
    PAGE_IN,
    VARIANTS,
    letter,
    logarithmic,
    new_figure,
    styled,
)

VALIDATED_S = 2.0
"""What Fig. 9 shows, by the paper's text to its Fig. 12."""

VARIANT_LINES = {"hamiltonian": "-", "as_printed": (0, (3, 1.5))}


@styled
def figure_08(statics: pd.DataFrame) -> Figure:
    """Tip x and z in equilibrium under dead tip loads along z: exact elastica, full and reduced order.

    `statics`: one row per load, columns of static_tip.csv.
    """
    figure = new_figure(PAGE_IN, 2.7)
    axes = figure.subplots(1, 2)
    for ax, axis in zip(axes, "xz", strict=True):
        _static_tip(ax, statics, axis)
        ax.set(xlabel="tip load [N]", ylabel=f"tip {axis} [m]")
    legend(figure, axes[:1], shaded=False)
    letter(axes)
    return figure


@styled
def static_deflection(statics: pd.DataFrame) -> Figure:
    """Tip position under dead tip loads, and how far either model lies from the exact elastica.

    Where no exact position is known, from the full-order model. `statics` as in `figure_08`.
    """
    figure = new_figure(PAGE_IN, 2.7)
    left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
    for axis, height in (("x", 0.62), ("z", 0.55)):
        _static_tip(left, statics, axis)
        at = int(height * len(statics))
        anchor = statics[f"{axis}_rom_m"].iloc[at]
        left.annotate(
            axis,
            (statics["load_N"].iloc[at], anchor),
            xytext=(0, 9),
            textcoords="offset points",
            ha="center",
            style="italic",
            fontsize=9,
        )
    left.margins(y=0.1)
    left.set(xlabel="tip load [N]", ylabel="tip position [m]", title="tip under a dead load along z")
    _static_errors(right, statics)
    legend(figure, (left,), shaded=False)
    letter((left, right))
    return figure


def _static_tip(ax: Axes, statics: pd.DataFrame, axis: str) -> None:
    """One coordinate of the tip against the load, of everything that has it."""
    load, exact = statics["load_N"], statics[f"{axis}_exact_m"]
    if exact.notna().any():
        ax.plot(load, exact, color=COLOURS["exact"], linewidth=1.6, zorder=1, label="exact elastica")
    full, reduced = (statics[f"{axis}_{model}_m"] for model in ("fom", "rom"))
    ax.plot(load, full, "o", color=COLOURS["fom"], markerfacecolor="none", zorder=3, label="full order")
    ax.plot(load, reduced, "x", color=COLOURS["rom"], markersize=3.5, zorder=2, label="reduced order")


def _static_errors(ax: Axes, statics: pd.DataFrame) -> None:
    """Distance of each model's tip from the exact one; from the full-order model's where none is exact."""
    truth, title = ("exact", "distance from the exact tip")
    if statics["x_exact_m"].isna().all():
        truth, title = ("fom", "distance from the full-order tip")
    styles = {"fom": ("o", COLOURS["fom"], "full order"), "rom": ("x", COLOURS["rom"], "reduced order")}
    loaded = statics[statics["load_N"] != 0.0]
    for model, (marker, colour, name) in styles.items():
        if model == truth:
            continue
        distance_m = np.hypot(
            loaded[f"x_{model}_m"] - loaded[f"x_{truth}_m"], loaded[f"z_{model}_m"] - loaded[f"z_{truth}_m"]
        )
        ax.plot(
            loaded["load_N"],
            1e3 * distance_m,
            marker=marker,
            color=colour,
            linewidth=0.8,
            label=name,
            markerfacecolor="none",
            markersize=3.5,
        )
    if truth == "exact":  # two models, decades apart
        logarithmic(ax, y=True)
    ax.set(xlabel="tip load [N]", ylabel="distance [mm]", title=title, xlim=(0, None))
    ax.legend(loc="lower right")


@styled
def figure_09(validation: pd.DataFrame) -> Figure:
    """Tip x and z in the first 2 s under the harmonic tip force: full and reduced order.

    `validation`: columns variant, model ("fom", "rom"), t_s, tip_x_m, tip_z_m. One column of panels for each
    variant.
    """
    variants = variants_in(validation)
    shown = validation[validation["t_s"] <= VALIDATED_S]
    figure = new_figure(PAGE_IN, 3.8)
    grid = figure.subplots(2, len(variants), sharex=True, sharey="row", squeeze=False)
    for column, variant in zip(grid.T, variants, strict=True):
        for ax, axis in zip(column, "xz", strict=True):
            for model, part in each(shown[shown["variant"] == variant]):
                style = (
                    {"linewidth": 1.8} if model == "fom" else {"linewidth": 0.9, "linestyle": (0, (3, 1.2))}
                )
                ax.plot(part["t_s"], part[f"tip_{axis}_m"], color=COLOURS[model], label=NAMES[model], **style)
            ax.margins(x=0.0)
        column[0].set_title(VARIANTS[variant], loc="left")
        column[-1].set_xlabel("time [s]")
    for row, axis in zip(grid, "xz", strict=True):
        row[0].set_ylabel(f"tip {axis} [m]")
    legend(figure, grid[0], shaded=False)
    letter(grid.ravel())
    return figure


@styled
def reduced_against_full(validation: pd.DataFrame) -> Figure:
    """Tip height under the study's load: full and reduced order, gyroscopic term kept and dropped.

    `validation` as in `figure_09`. The models have their colours, the variants their line styles; below, the
    differences that the first panel hides.
    """
    z = validation.pivot_table(index="t_s", columns=["variant", "model"], values="tip_z_m")
    variants = [variant for variant in VARIANT_LINES if variant in z.columns.get_level_values(0)]
    both = len(variants) == 2

    figure = new_figure(PAGE_IN, 5.0 if both else 3.9)
    axes = list(
        figure.subplots(3 if both else 2, 1, sharex=True, height_ratios=(1.5, 1, 1) if both else (1.5, 1))
    )
    for variant in variants:
        line = VARIANT_LINES[variant]
        axes[0].plot(z.index, z[variant, "fom"], color=COLOURS["fom"], linewidth=2.4, linestyle=line)
        axes[0].plot(z.index, z[variant, "rom"], color=COLOURS["rom"], linewidth=0.9, linestyle=line)
        axes[-1].plot(
            z.index,
            1e3 * (z[variant, "rom"] - z[variant, "fom"]),
            color=COLOURS["rom"],
            linewidth=0.9,
            linestyle=line,
        )
    axes[0].set(ylabel="tip height z [m]", title="response")
    axes[-1].set(ylabel="difference in z [mm]", xlabel="time [s]", title="reduced minus full order")
    if both:
        for model, width in (("fom", 2.4), ("rom", 0.9)):
            difference_m = z["as_printed", model] - z["hamiltonian", model]
            axes[1].plot(z.index, 1e3 * difference_m, color=COLOURS[model], linewidth=width)
        axes[1].set(ylabel="difference in z [mm]", title="term dropped minus term kept")
    axes[0].set_xlim(0.0, float(z.index[-1]))
    handles = [
        Line2D([], [], color=COLOURS["fom"], linewidth=2.4, label="full order"),
        Line2D([], [], color=COLOURS["rom"], linewidth=0.9, label="reduced order"),
    ]
    handles += [Line2D([], [], color=GREY, linestyle=VARIANT_LINES[v], label=VARIANTS[v]) for v in variants]
    figure.legend(handles=handles, loc="outside upper center", ncols=4)
    letter(axes)
    return figure
