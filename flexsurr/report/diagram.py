"""Boxes, neurons and arrows: what the schematics are drawn with. Lengths in the axes' own units."""

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, FancyBboxPatch

from flexsurr.report.style import BLACK, Array, new_figure

Point = tuple[float, float]


def pair(point: Array) -> Point:
    """The point (2,) as the two numbers that patches and texts ask for."""
    return float(point[0]), float(point[1])


def canvas(width_in: float, height_in: float, units_per_in: float = 1.0) -> tuple[Figure, Axes]:
    """A figure whose only axes fill it, without frame, one unit being 1/units_per_in inches."""
    figure = new_figure(width_in, height_in)
    figure.set_layout_engine("none")
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set(xlim=(0, width_in * units_per_in), ylim=(0, height_in * units_per_in), aspect="equal")
    ax.set_axis_off()
    return figure, ax


def block(
    ax: Axes, centre: Point, size: Point, text: str, colour: str = BLACK, fill: str = "white", **style: Any
) -> None:
    """A rounded box (w, h) with text in its middle."""
    (x, y), (w, h) = centre, size
    box = FancyBboxPatch(
        (x - w / 2, y - h / 2),
        w,
        h,
        boxstyle="round,pad=0,rounding_size=0.06",
        facecolor=fill,
        edgecolor=colour,
        linewidth=0.9,
        zorder=3,
    )
    ax.add_patch(box)
    ax.text(x, y, text, ha="center", va="center", zorder=4, **style)


def neuron(ax: Axes, centre: Point, text: str, colour: str, fill: str, radius: float = 0.13) -> None:
    """A circle with text in its middle."""
    ax.add_patch(Circle(centre, radius, facecolor=fill, edgecolor=colour, linewidth=0.9, zorder=3))
    ax.text(*centre, text, ha="center", va="center", zorder=4)


def arrow(ax: Axes, start: Point, end: Point, colour: str = BLACK, bend: str = "arc3,rad=0") -> None:
    """A thin arrow from start to end."""
    ax.add_patch(
        FancyArrowPatch(
            start,
            end,
            arrowstyle="-|>",
            mutation_scale=7,
            linewidth=0.8,
            color=colour,
            connectionstyle=bend,
            shrinkA=0,
            shrinkB=0,
            zorder=2,
        )
    )


def path(ax: Axes, points: Sequence[Point], colour: str = BLACK) -> None:
    """A line through points that ends in an arrow."""
    if len(points) > 2:
        ax.plot(
            *zip(*points[:-1], strict=True), color=colour, linewidth=0.8, zorder=2, solid_joinstyle="round"
        )
    arrow(ax, points[-2], points[-1], colour)


def connect(
    ax: Axes, left: Sequence[Point], right: Sequence[Point], colour: str, radius: float = 0.13
) -> None:
    """A thin line from every neuron on the left to every one on the right."""
    for a in left:
        for b in right:
            ax.plot(
                (a[0] + radius, b[0] - radius),
                (a[1], b[1]),
                color=colour,
                linewidth=0.45,
                alpha=0.6,
                zorder=1,
            )
