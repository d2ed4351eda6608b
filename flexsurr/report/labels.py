"""Labels beside points that overlap neither each other nor the points."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from flexsurr.report.style import Array

Point = tuple[float, float]

# Places to try [points]: all around the point, nearest first.
_DIRECTIONS = ((1, 0), (-1, 0), (0.7, 0.8), (-0.7, 0.8), (0.7, -0.8), (-0.7, -0.8), (0, 1), (0, -1))
_DISTANCES = (5, 9, 14, 20, 28, 38, 50)
_TIED_FROM = 14
"""Distance [points] from which a thin line ties the label to its point."""

_MARKER_HALF = 3.0
_PADDING = 0.8
"""Half a marker, and the least gap around a label [points]."""


def freeze_layout(figure: Figure) -> None:
    """Lay the figure out for good, so that pixels can be counted on."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")


def place_labels(
    ax: Axes,
    points: Sequence[Point],
    texts: Sequence[str],
    colours: Sequence[str],
    obstacles: Sequence[Point],
    size: float = 6,
) -> None:
    """Write texts[i] near points[i] (data coordinates), off all `obstacles` and whatever is written already.

    Greedy and deterministic: each label takes the nearest free place inside the axes, else the one
    with the least overlap. The layout must be frozen and the limits of the axes final.
    """
    figure = ax.get_figure(root=True)
    assert isinstance(figure, Figure)
    pixels = figure.dpi / 72.0
    frame = ax.get_window_extent()
    centres = ax.transData.transform(np.asarray(obstacles, dtype=float).reshape(-1, 2))
    half = _MARKER_HALF * pixels
    taken = [np.concatenate([centres - half, centres + half], axis=1)]
    taken += [np.array([text.get_window_extent().extents]) for text in ax.texts]
    places = [(distance, dx, dy) for distance in _DISTANCES for dx, dy in _DIRECTIONS]
    for point, text, colour in zip(points, texts, colours, strict=True):
        extent = _extent(ax, text, size) + 2.0 * _PADDING * pixels
        at = ax.transData.transform(point)
        boxes = np.array([_box(at, extent, pixels * distance, dx, dy) for distance, dx, dy in places])
        others = np.concatenate(taken)
        outside = np.prod(extent) - _overlaps(boxes, np.array([frame.extents]))[:, 0]
        # argmin takes the first of equals: the nearest free place
        best = int(np.argmin(np.round(_overlaps(boxes, others).sum(axis=1) + 3.0 * outside, 6)))
        taken.append(boxes[best : best + 1])
        distance, dx, dy = places[best]
        if distance >= _TIED_FROM:
            along = np.linspace(0.2, 0.9, 6)[:, None] * pixels * distance * np.array([dx, dy])
            taken.append(np.concatenate([at + along - pixels, at + along + pixels], axis=1))
        line = {"arrowstyle": "-", "lw": 0.4, "color": colour, "shrinkA": 0, "shrinkB": 2}
        ax.annotate(
            text,
            point,
            xytext=(dx * distance, dy * distance),
            textcoords="offset points",
            ha=_side(dx, ("right", "center", "left")),
            va=_side(dy, ("top", "center", "bottom")),
            fontsize=size,
            color=colour,
            path_effects=[withStroke(linewidth=1.2, foreground="white")],
            arrowprops=line if distance >= _TIED_FROM else None,
        )


def _side(direction: float, names: tuple[str, str, str]) -> str:
    return names[1 + int(np.sign(direction))]


def _extent(ax: Axes, text: str, size: float) -> Array:
    """Width and height (2,) of a text [px]."""
    words = ax.text(0.0, 0.0, text, fontsize=size)
    box = words.get_window_extent()
    words.remove()
    return np.array([box.width, box.height])


def _box(at: Array, extent: Array, distance: float, dx: float, dy: float) -> Array:
    """x0, y0, x1, y1 [px] of a label whose side or corner lies off `at` in direction (dx, dy)."""
    direction = np.array([dx, dy])
    corner = at + distance * direction - 0.5 * extent * (1.0 - np.sign(direction))
    return np.concatenate([corner, corner + extent])


def _overlaps(boxes: Array, others: Array) -> Array:
    """(m, k) common areas of boxes (m, 4) and others (k, 4)."""
    low = np.maximum(boxes[:, None, :2], others[None, :, :2])
    high = np.minimum(boxes[:, None, 2:], others[None, :, 2:])
    return np.asarray(np.prod(np.clip(high - low, 0.0, None), axis=-1))
