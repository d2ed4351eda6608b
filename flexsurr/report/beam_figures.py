"""Full and reduced order against exact statics and against each other: Figs. 8 and 9 of the study."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.report.style import (
    COLOURS,
    GREY,
    PAGE_IN,
    VARIANTS,
    letter,
    logarithmic,
    new_figure,
    styled,
)

WINDOW_S = (0.5, 1.0)
"""The part of the response that Fig. 9 of the study shows; all of a response that is longer."""

VARIANT_LINES = {"hamiltonian": "-", "as_printed": (0, (3, 1.5))}


@styled
def figure_08(statics: pd.DataFrame) -> Figure:
    """Tip position under dead tip loads, and how far either model lies from the exact elastica.

    `statics`: one row per load, columns of static_tip.csv.
    """
    figure = new_figure(PAGE_IN, 2.7)
    left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
    load = statics["load_N"]
    for axis, height in (("x", 0.62), ("z", 0.55)):
        exact = statics[f"{axis}_exact_m"]
        left.plot(load, exact, color=COLOURS["exact"], linewidth=1.6, zorder=1)
        left.plot(load, statics[f"{axis}_fom_m"], "o", color=COLOURS["fom"], markerfacecolor="none", zorder=3)
        left.plot(load, statics[f"{axis}_rom_m"], "x", color=COLOURS["rom"], markersize=3.5, zorder=2)
        at = int(height * len(load))
        anchor = statics[f"{axis}_rom_m" if exact.isna().all() else f"{axis}_exact_m"].iloc[at]
        left.annotate(
            f"{axis}",
            (load.iloc[at], anchor),
            xytext=(0, 9),
            textcoords="offset points",
            ha="center",
            style="italic",
            fontsize=9,
        )
    handles = {
        "exact elastica": left.plot([], [], color=COLOURS["exact"], linewidth=1.6)[0],
        "full order": left.plot([], [], "o", color=COLOURS["fom"], markerfacecolor="none")[0],
        "reduced order": left.plot([], [], "x", color=COLOURS["rom"], markersize=3.5)[0],
    }
    if statics["x_exact_m"].isna().all():
        del handles["exact elastica"]
    left.legend(
        list(handles.values()),
        list(handles),
        loc="center left",
        bbox_to_anchor=(0.02, 0.66),
    )
    left.margins(y=0.1)
    left.set(xlabel="tip load [N]", ylabel="tip position [m]", title="tip under a dead load along z")
    _static_errors(right, statics)
    letter((left, right))
    return figure


def _static_errors(ax: Axes, statics: pd.DataFrame) -> None:
    """Distance of each model's tip from the exact one; from the full-order model's where none is exact."""
    judge, title = ("exact", "distance from the exact tip")
    if statics["x_exact_m"].isna().all():
        judge, title = ("fom", "distance from the full-order tip")
    styles = {"fom": ("o", COLOURS["fom"], "full order"), "rom": ("x", COLOURS["rom"], "reduced order")}
    loaded = statics[statics["load_N"] != 0.0]
    for model, (marker, colour, name) in styles.items():
        if model == judge:
            continue
        distance_m = np.hypot(
            loaded[f"x_{model}_m"] - loaded[f"x_{judge}_m"], loaded[f"z_{model}_m"] - loaded[f"z_{judge}_m"]
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
    if judge == "exact":  # two models, decades apart
        logarithmic(ax, y=True)
    ax.set(xlabel="tip load [N]", ylabel="distance [mm]", title=title, xlim=(0, None))
    ax.legend(loc="lower right")


@styled
def figure_09(validation: pd.DataFrame) -> Figure:
    """Tip height under a harmonic tip force: full and reduced order, gyroscopic term kept and dropped.

    `validation`: columns variant, model ("fom", "rom"), t_s, tip_x_m, tip_z_m. The models have their
    colours, the variants their line styles; below, the differences that the first panel hides.
    """
    start_s, end_s = WINDOW_S
    longest_s = validation["t_s"].max()
    if not start_s < longest_s <= end_s:
        start_s, end_s = 0.0, longest_s
    shown = validation[validation["t_s"].between(start_s, end_s)]
    z = shown.pivot_table(index="t_s", columns=["variant", "model"], values="tip_z_m")
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
    axes[0].set_xlim(start_s, float(z.index[-1]))
    handles = [
        Line2D([], [], color=COLOURS["fom"], linewidth=2.4, label="full order"),
        Line2D([], [], color=COLOURS["rom"], linewidth=0.9, label="reduced order"),
    ]
    handles += [Line2D([], [], color=GREY, linestyle=VARIANT_LINES[v], label=VARIANTS[v]) for v in variants]
    figure.legend(handles=handles, loc="outside upper center", ncols=4)
    letter(axes)
    return figure
