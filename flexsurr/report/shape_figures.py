"""Shapes of a structure: its modes in space, and what static loads bend it to."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from flexsurr.report.style import BLUE, COLOURS, GREY, NAMES, PAGE_IN, new_figure, styled

AXES = ("x_m", "y_m", "z_m")
LABELS = ("x [m]", "y [m]", "z [m]")
COLUMNS = 2


@styled
def mode_shapes(shapes: pd.DataFrame) -> Figure:
    """The modes of the reduced model in space, each beside the shape about which it is taken.

    `shapes`: columns kind ("rest", "mode", "static"), number, omega_rad_s, load_N, model, line ("left",
    "axis", "right"), node, x_m, y_m, z_m.
    """
    rest, modes = (shapes[shapes["kind"] == kind] for kind in ("rest", "mode"))
    numbers = sorted(modes["number"].unique())
    columns = min(COLUMNS, len(numbers))
    rows = -(-len(numbers) // columns)
    figure = new_figure(PAGE_IN, 0.4 + 2.2 * rows)
    grid: Any = figure.subplots(rows, columns, squeeze=False, subplot_kw={"projection": "3d"})
    for ax in grid.flat[len(numbers) :]:
        ax.remove()
    reach = _reach(pd.concat([rest, modes]))
    for ax, number in zip(grid.flat, numbers, strict=False):
        mode = modes[modes["number"] == number]
        _surface(ax, rest, GREY, 0.25)
        _surface(ax, mode, BLUE, 0.8)
        ax.set(xlabel=LABELS[0], ylabel=LABELS[1], zlabel=LABELS[2])
        ax.set_title(f"mode {number}: {mode['omega_rad_s'].iloc[0]:.4g} rad/s", loc="left")
        ax.set(xlim=reach[0], ylim=reach[1], zlim=reach[2])
        ax.set_box_aspect([high - low for low, high in reach], zoom=1.1)
        ax.locator_params(nbins=4)
        ax.view_init(elev=22.0, azim=-62.0)
    handles = [Patch(color=BLUE, label="mode"), Patch(color=GREY, alpha=0.4, label="where it is taken")]
    figure.legend(handles=handles, loc="outside upper center", ncols=2)
    return figure


def _surface(ax: Any, shape: pd.DataFrame, colour: str, alpha: float) -> None:
    """The strip between the two edges of a shape, and its axis."""
    left, axis, right = (
        shape[shape["line"] == line].sort_values("node")[list(AXES)].to_numpy()
        for line in ("left", "axis", "right")
    )
    ax.plot_surface(*np.stack([left, right]).transpose(2, 0, 1), color=colour, alpha=alpha, linewidth=0.0)
    ax.plot(*axis.T, color=colour, linewidth=0.8)


def _reach(points: pd.DataFrame) -> list[tuple[float, float]]:
    """Limits of the three axes, none so narrow beside the longest that its numbers have no room."""
    low, high = points[list(AXES)].min().to_numpy(), points[list(AXES)].max().to_numpy()
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    half = np.maximum(half, 0.25 * half.max())
    return [(float(m - h), float(m + h)) for m, h in zip(middle, half, strict=True)]


@styled
def static_shapes(shapes: pd.DataFrame) -> Figure:
    """The structure in equilibrium under dead tip loads along z: full and reduced order, seen from the side.

    `shapes` as in `mode_shapes`.
    """
    static = shapes[shapes["kind"] == "static"]
    loads = sorted(static["load_N"].unique())
    figure = new_figure(PAGE_IN, 3.6)
    ax = figure.subplots()
    shades = colormaps["viridis"](np.linspace(0.0, 0.85, len(loads)))
    for load_N, shade in zip(loads, shades, strict=True):
        for model, part in static[static["load_N"] == load_N].groupby("model"):
            style: dict[str, Any] = {"linewidth": 2.0} if model == "fom" else {"linestyle": (0, (2.5, 1.5))}
            colour = shade if model == "fom" else COLOURS["rom"]
            ax.plot(part["x_m"], part["z_m"], color=colour, **style)
    handles = [
        Line2D([], [], color=GREY, linewidth=2.0, label=NAMES["fom"]),
        Line2D([], [], color=COLOURS["rom"], linestyle=(0, (2.5, 1.5)), label=NAMES["rom"]),
        *(
            Line2D([], [], color=shade, linewidth=2.0, label=f"{load:g} N")
            for load, shade in zip(loads, shades, strict=True)
        ),
    ]
    ax.set(xlabel=LABELS[0], ylabel=LABELS[2], aspect="equal")
    figure.legend(handles=handles, loc="outside right upper")
    return figure
