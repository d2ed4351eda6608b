"""The airliner: its panels in three dimensions, and where its mass is (Figs. 16 and 17 of the study)."""

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from flexsurr.report.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PAGE_IN,
    PURPLE,
    SKY,
    VERMILION,
    Array,
    new_figure,
    styled,
)

if TYPE_CHECKING:  # they bring along a compiler, which takes half a second
    from flexsurr.aerodynamics.lattice import Lattice
    from flexsurr.flight import FreeModes, StickModel

_VIEW = {"elev": 24.0, "azim": 225.0}
_CONTROLS = {"elevator": ORANGE, "aileron": VERMILION, "rudder": PURPLE}
_FUSELAGE_STATIONS, _FUSELAGE_SIDES = 40, 24
PARTS: dict[str, str] = {
    "fuselage and systems": GREY,
    "payload": SKY,
    "fuel": ORANGE,
    "wing structure": BLUE,
    "engine": VERMILION,
    "horizontal tail": GREEN,
    "vertical tail": PURPLE,
    "main gear": BLACK,
    "nose gear": BLACK,
}


@styled
def figure_16(modes: "FreeModes", lattice: "Lattice") -> Figure:
    """The panels of wing and tails, control surfaces in colour, with the fuselage as a body of revolution."""
    figure = new_figure(PAGE_IN, 4.4)
    ax = _axes(figure)
    body = _fuselage(modes.model)
    ax.add_collection3d(
        Poly3DCollection(body, facecolors="#EFEFEF", edgecolors="#DDDDDD", linewidths=0.2, clip_on=False)
    )
    colours = np.full(len(lattice), "#CFE3F2", dtype=object)
    turned = np.linalg.norm(lattice.hinge[:, 1:], axis=2) > 0.0
    for columns, colour in zip(((0, 1), (2, 3), (4,)), _CONTROLS.values(), strict=True):
        colours[turned[:, columns].any(axis=1)] = colour
    panels = Poly3DCollection(
        lattice.corners, facecolors=list(colours), edgecolors=BLUE, linewidths=0.3, clip_on=False
    )
    ax.add_collection3d(panels)
    handles = [
        Line2D([], [], marker="s", linestyle="", color=colour, label=name)
        for name, colour in _CONTROLS.items()
    ]
    ax.legend(handles=handles, loc="upper right")
    ax.set_title(
        f"{len(lattice)} panels: wing, horizontal and vertical tail; the fuselage carries none", loc="left"
    )
    _equal(ax, np.concatenate([lattice.corners.reshape(-1, 3), body.reshape(-1, 3)]), zoom=2.0)
    return figure


@styled
def figure_17(modes: "FreeModes") -> Figure:
    """Every lumped mass where it is, its area in proportion, over the beams; and the parts' sum."""
    model, centre_of_gravity = modes.model, modes.properties.centre_of_gravity
    figure = new_figure(PAGE_IN, 5.9)
    figure.set_layout_engine("constrained", compress=True)
    # equal aspects leave the two of different widths, so each has its own numbers
    top, side = figure.subplots(2, 1, height_ratios=(37.0, 15.0))
    masses = model.skeleton.masses
    for ax, across in ((top, 1), (side, 2)):
        for element in model.skeleton.elements:
            ax.plot(element.ends[:, 0], element.ends[:, across], color="#BBBBBB", linewidth=0.7, zorder=1)
        for part, colour in PARTS.items():
            lumps = [lump for lump in masses if lump.part == part]
            points = np.array([lump.position for lump in lumps])
            sizes = 0.12 * np.array([lump.mass for lump in lumps])
            ax.scatter(
                points[:, 0],
                points[:, across],
                s=sizes,
                color=colour,
                alpha=0.55,
                linewidths=0.3,
                edgecolors="white",
                zorder=2,
            )
        ax.plot(centre_of_gravity[0], centre_of_gravity[across], "+", color=BLACK, markersize=10, zorder=3)
        ax.set_aspect("equal")
        ax.margins(0.04, 0.08 if across == 1 else 0.25)
    top.set_ylabel("y, to the right [m]")
    side.set_ylabel("z, up [m]")
    side.set_xlabel("x, aft from the nose [m]")
    total = sum(lump.mass for lump in masses)
    handles = []
    for part, colour in PARTS.items():
        sum_kg = sum(lump.mass for lump in masses if lump.part == part)
        handles.append(
            Line2D([], [], marker="o", linestyle="", color=colour, label=f"{part}, {sum_kg:,.0f} kg")
        )
    cross = f"centre of gravity, x = {centre_of_gravity[0]:.2f} m"
    handles.append(Line2D([], [], marker="+", linestyle="", color=BLACK, label=cross))
    figure.legend(handles=handles, loc="outside right center")
    top.set_title(f"{total:,.0f} kg in {len(masses)} rigid bodies (distribution assumed)", loc="left")
    return figure


@styled
def elastic_modes(modes: "FreeModes", elastic: pd.DataFrame, largest_m: float = 2.5) -> Figure:
    """Elastic modes, each scaled to the same largest displacement, with what they are and the paper's number.

    `elastic`: `flexsurr.evaluation.airliner_modes.elastic_modes`, a row a mode that is shown.
    """
    figure = new_figure(PAGE_IN, 2.0 * ((len(elastic) + 1) // 2))
    nodes = modes.model.skeleton.nodes
    shapes = modes.shapes.reshape(len(nodes), 6, -1)
    for place, (_, mode) in enumerate(elastic.iterrows(), start=1):
        number = int(mode["mode"])
        ax = figure.add_subplot((len(elastic) + 1) // 2, 2, place, projection="3d", computed_zorder=False)
        _bare(ax)
        moved = shapes[:, :3, number - 1]
        moved = moved * (largest_m / np.linalg.norm(moved, axis=1).max())
        for offsets, colour, width in ((np.zeros_like(moved), "#CCCCCC", 0.6), (moved, BLUE, 1.1)):
            lines = [
                np.array([element.ends[i] + offsets[element.nodes[i]] for i in range(2)])
                for element in modes.model.skeleton.elements
            ]
            ax.add_collection3d(Line3DCollection(lines, colors=colour, linewidths=width, clip_on=False))
        paper = "" if pd.isna(mode["paper_mode"]) else f" (the paper's {mode['paper_mode']})"
        ax.set_title(f"{number}{paper}: {mode['frequency_hz']:.2f} Hz\n{mode['name']}", loc="left")
        _equal(ax, nodes, zoom=2.0)
    return figure


def _fuselage(model: "StickModel") -> Array:
    """Quadrilaterals (k, 4, 3) of a body of revolution, pointed at both ends."""
    aircraft = model.aircraft
    length, radius = aircraft.published.fuselage_length_m, 0.5 * aircraft.fuselage.diameter_m
    x = 0.5 * length * (1.0 - np.cos(np.linspace(0.0, np.pi, _FUSELAGE_STATIONS)))
    # the exponent whose power law has about the volume of the file's fullness
    profile = radius * (1.0 - np.abs(2.0 * x / length - 1.0) ** 6) ** 0.6
    angle = np.linspace(0.0, 2.0 * np.pi, _FUSELAGE_SIDES + 1)
    height = aircraft.fuselage.axis_z_m
    ring = np.stack(
        [
            np.broadcast_to(x[:, None], (len(x), len(angle))),
            profile[:, None] * np.cos(angle),
            height + profile[:, None] * np.sin(angle),
        ],
        axis=-1,
    )
    faces = np.stack([ring[:-1, :-1], ring[1:, :-1], ring[1:, 1:], ring[:-1, 1:]], axis=2)
    return faces.reshape(-1, 4, 3)


def _axes(figure: Figure) -> Axes3D:
    ax = figure.add_subplot(projection="3d")
    _bare(ax)
    return ax


def _bare(ax: Axes3D) -> None:
    ax.view_init(**_VIEW)
    ax.set_axis_off()


def _equal(ax: Axes3D, points: Array, zoom: float) -> None:
    """The same scale along each axis, close around `points` (n, 3)."""
    low, high = points.min(axis=0), points.max(axis=0)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    ax.set_box_aspect(high - low, zoom=zoom)
