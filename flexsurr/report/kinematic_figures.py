"""The chain and its frames, drawn from the kinematics that the models use: Figs. 3 and 4 of the paper."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Polygon, Rectangle

from flexsurr.config.structure import Structure
from flexsurr.report.diagram import arrow, canvas, pair
from flexsurr.report.style import BLACK, BLUE, GREY, PAGE_IN, VERMILION, Array, styled

DRAWN_ELEMENTS = 5
"""Few enough to see each; the models have as many as their configuration says."""

FRAMED_ELEMENT = 4
"""The element whose frames are drawn."""

TURNED_DEG = {"in_plane": 2.0, "out_of_plane": 12.0, "torsion": -5.0}
"""How far each joint is turned that the structure has, in the figure of frames."""

POSITION = "#9B4F86"


@styled
def figure_03(structure: Structure) -> Figure:
    """Discretisation, in the plane of bending: rigid elements, springs at their roots, lumped masses."""
    from flexsurr.beam import element_frames, node_positions  # here, for it takes half a second

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
    """The frames of eq. 1: G at the clamp, U_i and D_i of one element, and the position of its point P.

    Joints of the kinds that the structure has are turned: one without torsion is not twisted.
    """
    from flexsurr.beam import element_frames, node_positions  # here, for it takes half a second

    joints = tuple(joint for joint in structure.ordered_joints if joint in TURNED_DEG)
    beam = _few_elements(structure, joints or ("out_of_plane",)).model_copy(update={"length_m": 1.0})
    q = np.deg2rad(np.repeat([TURNED_DEG[joint] if joints else 0.0 for joint in beam.joints], DRAWN_ELEMENTS))
    straight, deformed = node_positions(beam, 0.0 * q), node_positions(beam, q)
    frames = element_frames(beam, q)
    figure, ax = canvas(PAGE_IN * 0.78, 3.3, 1.42 / PAGE_IN / 0.78)
    origin = np.array([0.24, 0.1])

    half_chord, i = 0.08, FRAMED_ELEMENT - 1
    for k in range(DRAWN_ELEMENTS):
        _plate(ax, origin, straight[k : k + 2], half_chord * np.eye(3)[:, 1], "white", k == i)
        _plate(ax, origin, deformed[k : k + 2], half_chord * frames[k][:, 1], "#E8E8E8", k == i)

    point = deformed[i] + 0.62 / DRAWN_ELEMENTS * frames[i][:, 0] - 0.6 * half_chord * frames[i][:, 1]
    for at, axes, size, colour, name in (
        (np.zeros(3), np.eye(3), 0.19, BLACK, "G"),
        (straight[i], np.eye(3), 0.14, BLUE, "U_i"),
        (deformed[i], frames[i], 0.14, VERMILION, "D_i"),
    ):
        texts = [f"${axis}_{{{name}}}$" for axis in "xyz"]
        _frame(ax, origin, at, axes, size, colour, texts)
    for text, at, offset, colour in (
        ("$G$: inertial,\nat the clamp", np.zeros(3), (-0.21, -0.05), BLACK),
        ("$U_i$: undeformed,\ninertial", straight[i], (0.03, -0.1), BLUE),
        ("$D_i$: deformed", deformed[i], (0.13, -0.06), VERMILION),
    ):
        _note(ax, text, _seen(origin, at), np.array(offset), colour)

    end = _seen(origin, point)
    for start, text, share, gap in (
        (np.zeros(3), "$\\mathbf{r}_{P,i}$", 0.62, (-0.02, 0.035)),
        (deformed[i], "$\\mathbf{r}_{P,i,D_i}$", 0.6, (0.07, -0.015)),
    ):
        tail = _seen(origin, start)
        arrow(ax, pair(tail), pair(end), POSITION)
        ax.text(
            *pair(tail + share * (end - tail) + np.array(gap)), text, ha="center", va="center", color=POSITION
        )
    ax.add_patch(Circle(pair(end), 0.009, facecolor=BLACK, zorder=5))
    ax.text(end[0] + 0.028, end[1], "$P$", ha="center", va="center")
    return figure


def _plate(ax: Axes, origin: Array, ends: Array, half_chord: Array, fill: str, framed: bool) -> None:
    """One element, from `ends` (2, 3), with its chord; its outline is dark if its frames are drawn."""
    corners = np.array(
        [ends[0] - half_chord, ends[1] - half_chord, ends[1] + half_chord, ends[0] + half_chord]
    )
    plate = Polygon(
        _seen(origin, corners),
        facecolor=fill,
        edgecolor="#555555" if framed else "#B0B0B0",
        linewidth=1.0 if framed else 0.6,
        zorder=1.2 if framed else 1.0,
    )
    ax.add_patch(plate)


def _few_elements(structure: Structure, joints: tuple[str, ...]) -> Structure:
    """The structure with few elements, these joints and an unturned clamp: only its lengths are drawn."""
    stiffness = 1.0
    return structure.model_copy(
        update={
            "elements": DRAWN_ELEMENTS,
            "joints": joints,
            "joint_rotation": "sequence",
            "along_span": None,
            "point_masses": (),
            "mass_per_length_kg_m": 1.0,
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
    """The coordinate of a joint: from the direction of the element before it to its own."""
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
    ax.text(text[0], text[1], f"$q_{number}$", ha="center", va="center")


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
    ax: Axes, origin: Array, at: Array, axes: Array, size: float, colour: str, names: Sequence[str]
) -> None:
    """The axes (3, 3), columns, as arrows from `at`, with `names` at their ends."""
    for column, name in enumerate(names):
        end = _seen(origin, at + size * axes[:, column])
        arrow(ax, pair(_seen(origin, at)), pair(end), colour)
        along = _seen(np.zeros(2), axes[:, column])
        text = end + 0.035 * along / np.linalg.norm(along)
        ax.text(*pair(text), name, ha="center", va="center", color=colour)


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
