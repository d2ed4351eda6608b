"""Motions of a structure, moving: the reference and its surrogates side by side, as a GIF or a page.

matplotlib draws and Pillow writes; a page holds its pictures, and asks no network for anything.
"""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.animation import FuncAnimation
from matplotlib.figure import Figure
from PIL import Image

from flexsurr.report.style import BLUE, GREY, PAGE_IN, STYLE, colour, has_family, label, new_figure
from flexsurr.simulation.rhs import Array
from flexsurr.storage import replacing

ENDINGS = (".gif", ".html")
FRAMES_A_SECOND = 20
TRAIL = 40
"""Frames for which the tip's way is seen."""

# The signs on the buttons of matplotlib's player, which it would fetch from a network.
SIGNS = {
    "fa-minus": "−",
    "fa-fast-backward": "⏮",
    "fa-step-backward": "◂",
    "fa-play fa-flip-horizontal": "◀",
    "fa-pause": "❚❚",
    "fa-play": "▶",
    "fa-step-forward": "▸",
    "fa-fast-forward": "⏭",
    "fa-plus": "+",
}


class Moving:
    """A figure with a panel for each motion, and what moves in it.

    `motions` maps the name of a model to its nodes (m, N + 1, 3) [m] at times `t` (m,) [s]; one that ended
    early has fewer rows, and its panel says so. The first is the reference, which stands grey behind the
    others. A motion in the plane of x and z is seen from the side, any other in space.
    """

    def __init__(self, motions: Mapping[str, Array], t: Array, title: str) -> None:
        self.motions, self.t, self.title = motions, t, title
        self.reference, *others = motions
        self.shown = others or [self.reference]
        points = np.concatenate([nodes.reshape(-1, 3) for nodes in motions.values()])
        self.flat = bool(np.ptp(points[:, 1]) < 1e-9 * np.ptp(points))
        self.figure = self._panels(points)
        # placed once, for all frames
        self.figure.canvas.draw()
        self.figure.set_layout_engine("none")
        if not self.flat:  # what lays a figure out does not see the labels of axes in space
            for k, ax in enumerate(self.figure.axes):
                ax.set_position(((k + 0.02) / len(self.shown), 0.08, 0.8 / len(self.shown), 0.78))

    @property
    def frames(self) -> int:
        """As many as times."""
        return len(self.t)

    def _panels(self, points: Array) -> Figure:
        panels = len(self.shown)
        figure = new_figure(max(PAGE_IN, 2.4 * panels), 3.2)
        projection = {} if self.flat else {"projection": "3d"}
        grid: Any = figure.subplots(1, panels, squeeze=False, subplot_kw=projection)[0]
        low, high = points.min(axis=0), points.max(axis=0)
        middle, half = 0.5 * (low + high), np.maximum(0.55 * (high - low), 0.15 * (high - low).max())
        limits = [(m - h, m + h) for m, h in zip(middle, half, strict=True)]
        self.lines: list[tuple[str, Any, Any]] = []
        self.titles: list[tuple[str, Any]] = []
        for ax, name in zip(grid, self.shown, strict=True):
            self._frame(ax, limits)
            self.titles.append((name, ax.set_title(_called(name), loc="left")))
            for drawn in dict.fromkeys((self.reference, name)):
                behind = drawn == self.reference and name != self.reference
                style = (
                    {"color": GREY, "linewidth": 3.0}
                    if behind
                    else {"color": _colour(drawn), "linewidth": 1.4}
                )
                empty: list[list[float]] = [[]] * (2 if self.flat else 3)
                (line,) = ax.plot(*empty, "o-", markersize=2.0, **style)
                (trail,) = ax.plot(*empty, color=style["color"], linewidth=0.6)
                self.lines.append((drawn, line, trail))
        key = f"  (grey: {_called(self.reference)})" if self.shown != [self.reference] else ""
        figure.suptitle(self.title + key, x=0.01, ha="left", fontsize=8)
        self.clock = figure.text(0.99, 0.98, "", ha="right", va="top", fontsize=8)
        return figure

    def _frame(self, ax: Any, limits: list[tuple[float, float]]) -> None:
        if self.flat:
            ax.set(xlabel="x [m]", ylabel="z [m]", xlim=limits[0], ylim=limits[2], aspect="equal")
            return
        ax.set_xlabel("x [m]", labelpad=0.0)
        ax.set_ylabel("y [m]", labelpad=-4.0)
        ax.set_zlabel("z [m]", labelpad=-8.0)
        ax.tick_params(pad=0.0)
        ax.set(xlim=limits[0], ylim=limits[1], zlim=limits[2])
        ax.set_box_aspect([high - low for low, high in limits], zoom=1.1)
        for axis, sides in ((ax.xaxis, limits[0]), (ax.yaxis, limits[1]), (ax.zaxis, limits[2])):
            short = np.ptp(sides) < 0.5 * max(np.ptp(each) for each in limits)
            axis.get_major_locator().set_params(nbins=2 if short else 4)

    def show(self, frame: int) -> list[Any]:
        """Move everything to one of the times, and return it; a motion that has ended stays where it was."""
        for name, line, trail in self.lines:
            nodes = self.motions[name]
            at = min(frame, len(nodes) - 1)
            self._place(line, nodes[at])
            self._place(trail, nodes[max(0, at - TRAIL) : at + 1, -1])
        for name, title in self.titles:
            last = len(self.motions[name]) - 1
            ended = f", ended at {self.t[last]:.3g} s" if frame > last else ""
            title.set_text(_called(name) + ended)
        self.clock.set_text(f"{self.t[frame]:.3g} s")
        return self.moving

    @property
    def moving(self) -> list[Any]:
        """All that differs between frames."""
        lines = (each for _, line, trail in self.lines for each in (line, trail))
        return [*lines, *(title for _, title in self.titles), self.clock]

    def pictures(self) -> Iterator[Image.Image]:
        """The frames, one after another: what does not move is drawn once for all of them."""
        canvas: Any = self.figure.canvas
        for artist in self.moving:
            artist.set_animated(True)
        canvas.draw()
        still = canvas.copy_from_bbox(self.figure.bbox)
        for frame in range(self.frames):
            canvas.restore_region(still)
            for artist in self.show(frame):
                self.figure.draw_artist(artist)
            yield Image.fromarray(np.array(canvas.buffer_rgba())).convert("RGB")

    def _place(self, line: Any, points: Array) -> None:
        if self.flat:
            line.set_data(points[:, 0], points[:, 2])
        else:
            line.set_data_3d(*points.T)


def _colour(name: str) -> str:
    return colour(name) if has_family(name) else BLUE


def _called(name: str) -> str:
    return label(name) if has_family(name) else name


def save_animation(motions: Mapping[str, Array], t: Array, title: str, path: Path) -> None:
    """Write the motions to `path`, a .gif or a .html, whole or not at all. `Moving` says what they hold.

    ValueError for another ending, or where there is nothing to show.
    """
    if path.suffix not in ENDINGS:
        raise ValueError(f"{path}: allowed endings: {', '.join(ENDINGS)}")
    if not motions or any(len(nodes) == 0 for nodes in motions.values()):
        raise ValueError(f"{path}: there is no motion to show")
    with matplotlib.rc_context(STYLE):
        moving = Moving(motions, t, title)
        with replacing(path) as beside:
            if path.suffix == ".html":
                beside.write_text(_page(moving), encoding="utf-8")
            else:
                first, *others = moving.pictures()
                each_ms = 1000 // FRAMES_A_SECOND
                first.save(beside, "GIF", save_all=True, append_images=others, duration=each_ms, loop=0)


def _page(moving: Moving) -> str:
    """The player of matplotlib with its pictures, without what it would fetch."""
    film = FuncAnimation(moving.figure, moving.show, frames=moving.frames, blit=False)
    player = re.sub(r"<link[^>]*>", "", film.to_jshtml(fps=FRAMES_A_SECOND, embed_frames=True))
    for icon, sign in SIGNS.items():
        player = player.replace(f'<i class="fa {icon}"></i>', sign)
    head = f'<head><meta charset="utf-8"><title>{moving.title}</title></head>'
    return f'<!DOCTYPE html>\n<html lang="en">{head}\n<body>{player}</body></html>\n'
