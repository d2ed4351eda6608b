"""Labels beside points that overlap neither each other nor the points."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text
from matplotlib.transforms import Bbox

# Offsets [points] of the label's anchor from its point, nearest first: all around, then further out.
_DIRECTIONS = [(1, 0), (-1, 0), (0.7, 0.8), (-0.7, 0.8), (0.7, -0.8), (-0.7, -0.8), (0, 1), (0, -1)]
_DISTANCES = (5, 9, 14, 20, 28, 38)


def place_labels(
    ax: Axes,
    points: Sequence[tuple[float, float]],
    texts: Sequence[str],
    colours: Sequence[str],
    obstacles: Sequence[tuple[float, float]],
    size: float = 6,
) -> None:
    """Write texts[i] near points[i] (data coordinates), off all `obstacles` and earlier labels.

    Greedy and deterministic: each label takes the nearest free place inside the axes, else the one
    with the least overlap. A label further away is tied to its point by a thin line. Call it last:
    the layout and the limits of the axes are frozen here.
    """
    figure = ax.figure
    figure.canvas.draw()
    assert isinstance(figure.canvas, FigureCanvasAgg)
    renderer = figure.canvas.get_renderer()
    scale = figure.dpi / 72.0
    frame = ax.get_window_extent(renderer)
    half = 3.0 * scale
    taken = [
        Bbox.from_extents(x - half, y - half, x + half, y + half)
        for x, y in ax.transData.transform(np.asarray(obstacles, dtype=float).reshape(-1, 2))
    ]
    for point, text, colour in zip(points, texts, colours, strict=True):
        best = None
        for distance in _DISTANCES:
            for dx, dy in _DIRECTIONS:
                label = ax.annotate(
                    text,
                    point,
                    xytext=(dx * distance, dy * distance),
                    textcoords="offset points",
                    ha="left" if dx > 0 else "right" if dx < 0 else "center",
                    va="center" if dy == 0 else "bottom" if dy > 0 else "top",
                    fontsize=size,
                    color=colour,
                    arrowprops=(
                        {"arrowstyle": "-", "lw": 0.4, "color": colour, "shrinkA": 0, "shrinkB": 2}
                        if distance > _DISTANCES[1]
                        else None
                    ),
                )
                label.update_positions(renderer)
                # the box of the words alone: that of the annotation includes its line
                box = Text.get_window_extent(label, renderer).expanded(1.02, 1.05)
                overlap = sum(_overlap(box, other) for other in taken) + 3.0 * _outside(box, frame)
                if best is None or overlap < best[0]:
                    if best is not None:
                        best[1].remove()
                    best = (overlap, label, box)
                else:
                    label.remove()
                if best[0] == 0.0:
                    break
            if best is not None and best[0] == 0.0:
                break
        if best is not None:
            taken.append(best[2])


def _overlap(a: Bbox, b: Bbox) -> float:
    width = min(a.x1, b.x1) - max(a.x0, b.x0)
    height = min(a.y1, b.y1) - max(a.y0, b.y0)
    return width * height if width > 0 and height > 0 else 0.0


def _outside(box: Bbox, frame: Bbox) -> float:
    inside = _overlap(box, frame)
    return box.width * box.height - inside
