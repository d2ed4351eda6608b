"""The chain and its frames, drawn from the kinematics that the models use: Figs. 3 and 4 of the study."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Polygon, Rectangle

from flexsurr.beam import element_frames, node_positions
from flexsurr.config.structure import Structure
from flexsurr.report.diagram import arrow, canvas, pair
from flexsurr.report.style import BLACK, BLUE, GREEN, GREY, PAGE_IN, VERMILION, styled
from flexsurr.simulation.rhs import Array

DRAWN_ELEMENTS = 5
"""Few enough to see each; the models have as many as their configuration says."""

# Shades of the three axes of a frame.
AXES_COLOURS = (VERMILION, GREEN, BLUE)
POSITION = "#9B4F86"


@styled
def figure_03(structure: Structure) -> Figure:
    """Discretisation, in the plane of bending: rigid elements, springs at their roots, lumped masses."""
    # a schematic: every length in it is a share of the span
    beam = _few_elements(structure, ("out_of_plane",)).model_copy(update={"length_m": 1.0})
    q = np.deg2rad([9.0, 11.0, 12.0, 11.0, 9.0])
    nodes, frames = node_positions(beam, q)[:, [0, 2]], element_frames(beam, q)
    length = beam.length_m / DRAWN_ELEMENTS
    masses = nodes[:-1] + 0.5 * length * frames[:, [0, 2], 0]

    units = 1.24 * beam.length_m / PAGE_IN / 0.72
    figure, ax = canvas(PAGE_IN * 0.72, 2.85, units)
    origin = np.array([0.13, 0.13]) * beam.length_m
    nodes, masses = nodes + origin, masses + origin
    size = 0.018 * beam.length_m

    ax.plot(
        (origin[0], origin[0] + beam.length_m),
        (origin[1], origin[1]),
        color=GREY,
        lw=0.8,
        ls=(0, (6, 3)),
        zorder=1,
    )
    ax.text(
        origin[0] + 0.99 * beam.length_m, origin[1] - 0.02, "undeformed", ha="right", va="top", color=GREY
    )
    _clamp(ax, origin, 0.09 * beam.length_m)
    for i in range(DRAWN_ELEMENTS):
        ax.plot(*nodes[i : i + 2].T, color=BLACK, linewidth=3.2, solid_capstyle="butt", zorder=2)
    for i, node in enumerate(nodes[:-1]):
        ax.add_patch(
            Circle(pair(node), 0.75 * size, facecolor="white", edgecolor=BLACK, linewidth=1.0, zorder=4)
        )
        _spiral_spring(ax, node, 1.9 * size)
        _turn(ax, node, nodes[i] - nodes[i - 1] if i else np.array([1.0, 0.0]), q[i], 0.9 * length, i + 1)
    for i, mass in enumerate(masses):
        ax.add_patch(
            Circle(pair(mass), 1.05 * size, facecolor=BLUE, edgecolor="white", linewidth=0.8, zorder=5)
        )
        normal = np.array([frames[i, 0, 2], frames[i, 2, 2]])
        ax.text(
            *pair(mass + 0.05 * beam.length_m * normal), rf"$m_{i + 1}$", ha="center", va="center", color=BLUE
        )

    top = origin + np.array([-0.03, 0.515]) * beam.length_m
    entries = (
        ("rigid element, length $l = L/N$", "element"),
        ("joint and its spring, $k = EI/l$", "joint"),
        (r"mass $m = \mu\, l$ at mid-element", "mass"),
    )
    for row, (text, kind) in enumerate(entries):
        at = top - np.array([0.0, 0.075 * row * beam.length_m])
        if kind == "element":
            ax.plot(
                (at[0] - 0.03, at[0] + 0.03),
                (at[1], at[1]),
                color=BLACK,
                linewidth=3.2,
                solid_capstyle="butt",
            )
        elif kind == "joint":
            ax.add_patch(
                Circle(pair(at), 0.75 * size, facecolor="white", edgecolor=BLACK, linewidth=1.0, zorder=4)
            )
            _spiral_spring(ax, at, 1.9 * size)
        else:
            ax.add_patch(Circle(pair(at), 1.05 * size, facecolor=BLUE, edgecolor="white", linewidth=0.8))
        ax.text(at[0] + 0.06, at[1], text, ha="left", va="center")
    _dimension(ax, nodes[3], nodes[4], 0.085 * beam.length_m, "$l$")
    return figure


@styled
def figure_04(structure: Structure) -> Figure:
    """Frames: the inertial one, that of each element, and the position vector of one lumped mass."""
    beam = _few_elements(structure, ("in_plane", "out_of_plane", "torsion"))
    q = np.deg2rad(np.repeat([3.0, 7.0, -4.0], DRAWN_ELEMENTS))
    nodes, frames = node_positions(beam, q), element_frames(beam, q)
    length = beam.length_m / DRAWN_ELEMENTS
    offset = 0.055 * beam.length_m
    masses = nodes[:-1] + 0.5 * length * frames[..., 0] + offset * frames[..., 1]

    units = 1.3 * beam.length_m / PAGE_IN / 0.72
    figure, ax = canvas(PAGE_IN * 0.72, 2.75, units)
    origin = np.array([0.25, 0.12]) * beam.length_m

    half_chord = 0.09 * beam.length_m
    for i in range(DRAWN_ELEMENTS):
        y = half_chord * frames[i, :, 1]
        corners = np.array([nodes[i] - y, nodes[i + 1] - y, nodes[i + 1] + y, nodes[i] + y])
        ax.add_patch(
            Polygon(_seen(origin, corners), facecolor="#EFEFEF", edgecolor="#9A9A9A", linewidth=0.7, zorder=1)
        )
    ax.plot(*_seen(origin, nodes).T, color=GREY, linewidth=1.0, zorder=1.5)
    for i in range(DRAWN_ELEMENTS):
        names = "xyz" if i == DRAWN_ELEMENTS - 1 else ""
        _frame(
            ax, origin, nodes[i], frames[i], 0.11 * beam.length_m, AXES_COLOURS, [f"${n}_5$" for n in names]
        )
        ax.add_patch(Circle(pair(_seen(origin, masses[i])), 0.012 * beam.length_m, facecolor=BLACK, zorder=5))
        middle = nodes[i] + 0.5 * length * frames[i, :, 0]
        ax.plot(*_seen(origin, np.array([middle, masses[i]])).T, color=BLACK, linewidth=0.8, zorder=3)
    _frame(ax, origin, np.zeros(3), np.eye(3), 0.27 * beam.length_m, (BLACK,) * 3, ("$x$", "$y$", "$z$"))

    k = 3
    mass = _seen(origin, masses[k])
    arrow(ax, pair(origin), pair(mass), POSITION)
    above, below = np.array([[-0.36, 0.22], [0.07, -0.2]]) * beam.length_m
    _note(ax, rf"$r_{k + 1}(q)$, position of mass {k + 1} (eq. 1)", 0.5 * (origin + mass), above, POSITION)
    _note(
        ax,
        "offset of the\ncentre of gravity",
        _seen(origin, 0.5 * (masses[k - 1] + 0.5 * (nodes[k - 1] + nodes[k]))),
        below,
        BLACK,
    )
    return figure


def _few_elements(structure: Structure, joints: tuple[str, ...]) -> Structure:
    """The structure with few elements, these joints and an unturned clamp: only its lengths are drawn."""
    stiffness = structure.section_stiffness(structure.ordered_joints[0])
    return structure.model_copy(
        update={
            "elements": DRAWN_ELEMENTS,
            "joints": joints,
            "bending_stiffness_in_plane_N_m2": stiffness,
            "bending_stiffness_out_of_plane_N_m2": stiffness,
            "torsional_stiffness_N_m2": stiffness,
            "clamp_psi_deg": 0.0,
            "clamp_theta_deg": 0.0,
            "clamp_phi_deg": 0.0,
        }
    )


def _clamp(ax: Axes, at: Array, half: float) -> None:
    """A hatched wall to the left of `at`."""
    wall = Rectangle(
        (at[0] - 0.5 * half, at[1] - half),
        0.5 * half,
        2 * half,
        facecolor="none",
        edgecolor=GREY,
        hatch="/////",
        linewidth=0.0,
        zorder=1,
    )
    ax.add_patch(wall)
    ax.plot((at[0], at[0]), (at[1] - half, at[1] + half), color=BLACK, linewidth=1.4, zorder=2)


def _spiral_spring(ax: Axes, at: Array, radius: float) -> None:
    """A torsion spring around the joint at `at`."""
    turn = np.linspace(-0.5 * np.pi, 3.5 * np.pi, 120)
    r = radius * (0.5 + 0.5 * np.linspace(0.0, 1.0, turn.size))
    ax.plot(at[0] + r * np.cos(turn), at[1] + r * np.sin(turn), color=VERMILION, linewidth=0.9, zorder=3)


def _turn(ax: Axes, at: Array, before: Array, angle: float, radius: float, number: int) -> None:
    """The angle of a joint: from the direction of the element before it to its own."""
    start = np.arctan2(before[1], before[0])
    end = at + radius * np.array([np.cos(start), np.sin(start)])
    ax.plot((at[0], end[0]), (at[1], end[1]), color=GREY, linewidth=0.6, linestyle=(0, (3, 2)), zorder=1)
    arc = Arc(
        pair(at),
        1.8 * radius,
        1.8 * radius,
        theta1=np.rad2deg(start),
        theta2=np.rad2deg(start + angle),
        linewidth=0.8,
    )
    ax.add_patch(arc)
    text = at + 0.86 * radius * np.array([np.cos(start), np.sin(start)])
    text += 0.2 * radius * np.array([np.sin(start), -np.cos(start)])
    ax.text(text[0], text[1], rf"$\theta_{number}$", ha="center", va="center")


def _dimension(ax: Axes, start: Array, end: Array, distance: float, text: str) -> None:
    """A dimension line beside the straight line from start to end, on its upper side."""
    along = (end - start) / np.linalg.norm(end - start)
    across = distance * np.array([-along[1], along[0]])
    a, b = start + across, end + across
    ax.annotate(
        "",
        pair(a),
        pair(b),
        arrowprops={"arrowstyle": "<|-|>", "lw": 0.6, "color": BLACK, "shrinkA": 0, "shrinkB": 0},
    )
    for point, line_end in ((start, a), (end, b)):
        ax.plot(*np.array([point + 0.25 * across, line_end + 0.12 * across]).T, color=GREY, linewidth=0.5)
    ax.text(*pair(0.5 * (a + b) + 0.35 * across), text, ha="center", va="center")


def _seen(origin: Array, points: Array) -> Array:
    """(..., 2) parallel projection of points (..., 3): x to the right, y into the page, z up."""
    right, into, up = (0.93, 0.13), (-0.42, 0.40), (0.0, 0.93)
    return np.asarray(origin + points @ np.array([right, into, up]))


def _frame(
    ax: Axes,
    origin: Array,
    at: Array,
    axes: Array,
    size: float,
    colours: Sequence[str],
    names: Sequence[str],
) -> None:
    """The axes (3, 3), columns, as arrows from `at`, with `names` at their ends if there are any."""
    for column, colour in enumerate(colours):
        end = _seen(origin, at + size * axes[:, column])
        arrow(ax, pair(_seen(origin, at)), pair(end), colour)
    for column, name in enumerate(names):
        direction = _seen(np.zeros(2), axes[:, column])
        along = direction / np.linalg.norm(direction)
        # x lies on the elastic axis: its name stands beside the line
        gap = 0.045 * (np.array([along[1], -along[0]]) if column == 0 and axes[2, 0] > 0.0 else along)
        text = _seen(origin, at + size * axes[:, column]) + gap
        ax.text(*pair(text), name, ha="center", va="center", color=colours[column])


def _note(ax: Axes, text: str, at: Array, offset: Array, colour: str) -> None:
    """Text at `at` + `offset`, tied to `at` by a thin line."""
    ax.annotate(
        text,
        pair(at),
        pair(at + offset),
        ha="left",
        va="center",
        color=colour,
        arrowprops={"arrowstyle": "-", "lw": 0.5, "color": colour, "shrinkA": 1, "shrinkB": 1},
    )
