"""Horseshoe lattices: several lifting surfaces, each a row of trapezoids, cut into panels; the airliner's.

The lattice lies in planes parallel to x: dihedral shapes it, while incidence and twist turn the normals
alone, as control surfaces and elastic motion do later. The bound vortex runs along a quarter of each
panel's chord, left to right (upwards on a vertical surface), the control point lies at three quarters
of its middle chord. The planform of a surface serves the beam within it too.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from flexsurr.aerodynamics.features import CONTROLS
from flexsurr.config.aerodynamics import PanelCounts
from flexsurr.config.aircraft import Aircraft, ControlSurface, Surface
from flexsurr.simulation.rhs import Array


class Planform:
    """The right (or only) half of a surface; lengths along it are measured from its root.

    `ends` (k + 1,) are the lengths [m] at which its k sections meet, root and tip included, `corners`
    (k + 1, 3) [m] its leading edge there, and `spans` (k + 1,) [m] its span coordinates: y, or height above
    the root where the surface is `vertical`.
    """

    def __init__(self, surface: Surface, vertical: bool = False) -> None:
        self.vertical = vertical
        sections = surface.sections
        lengths = np.array([section.length_m for section in sections])
        self.ends = np.concatenate([[0.0], np.cumsum(lengths)])
        dihedral = np.radians([section.dihedral_deg for section in sections]) + (
            0.5 * np.pi if vertical else 0.0
        )
        sweep = np.radians([section.sweep_deg for section in sections])
        # sweep is that of the leading edge against its own projection on the y-z plane
        steps = np.stack([np.tan(sweep), np.cos(dihedral), np.sin(dihedral)], axis=1) * lengths[:, None]
        self.corners = np.array(surface.root_m) + np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
        self.spans = self.corners[:, 2] - self.corners[0, 2] if vertical else self.corners[:, 1]
        self._chords = np.array([sections[0].chord_m[0], *(section.chord_m[1] for section in sections)])

    def leading_edge(self, length: Array) -> Array:
        """Points (m, 3) [m] of the leading edge at lengths (m,)."""
        return np.stack([np.interp(length, self.ends, column) for column in self.corners.T], axis=-1)

    def chord(self, length: Array) -> Array:
        """Chord [m] at lengths (m,)."""
        chord: Array = np.interp(length, self.ends, self._chords)
        return chord


MIRROR = np.array([1.0, -1.0, 1.0])
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Lattice:
    """N panels in geometry axes [m]: x aft, y right, z up.

    `start`, `end` (N, 3) of the bound vortices; `control` points (N, 3); unit `normal` (N, 3), upwards
    or, on a vertical surface, to the left; `hinge` (N, CONTROLS, 3): the unit axis about which each
    control turns the normal of the panel, zero where it does not; `corners` (N, 4, 3), leading edge
    first, for drawings; `surface` (N,): which of `surfaces` a panel belongs to.
    """

    start: Array
    end: Array
    control: Array
    normal: Array
    hinge: Array
    corners: Array
    surface: NDArray[np.int64]
    surfaces: tuple[str, ...]

    def __len__(self) -> int:
        """Number of panels N."""
        return len(self.start)

    @property
    def bound(self) -> Array:
        """Midpoints (N, 3) of the bound vortices, where the forces act."""
        return 0.5 * (self.start + self.end)

    @classmethod
    def joined(cls, parts: Sequence["Lattice"]) -> "Lattice":
        """One lattice of several."""
        names = tuple(dict.fromkeys(name for part in parts for name in part.surfaces))
        fields = ("start", "end", "control", "normal", "hinge", "corners")
        arrays = {name: np.concatenate([getattr(part, name) for part in parts]) for name in fields}
        places = [[names.index(name) for name in part.surfaces] for part in parts]
        surface = [np.array(place)[part.surface] for place, part in zip(places, parts, strict=True)]
        return cls(**arrays, surface=np.concatenate(surface), surfaces=names)

    def mirrored(self) -> "Lattice":
        """The other side of the plane y = 0; without hinges, whose signs are the controls' affair."""
        normal = self.normal * MIRROR
        return Lattice(
            start=self.end * MIRROR,  # bound vortices still run from left to right
            end=self.start * MIRROR,
            control=self.control * MIRROR,
            normal=normal,
            hinge=np.zeros_like(self.hinge),
            corners=self.corners[:, [1, 0, 3, 2]] * MIRROR,
            surface=self.surface,
            surfaces=self.surfaces,
        )


def panel(
    surface: Surface,
    name: str,
    spanwise: int,
    chordwise: int,
    *,
    vertical: bool = False,
    flap: ControlSurface | None = None,
) -> tuple[Lattice, Array]:
    """The right (or only) half of `surface`: `spanwise` strips of `chordwise` panels, strip by strip.

    Strips share the sections, and the parts of the span that `flap` makes, by length; panels end at its
    hinge. The array (N, 3) holds unit vectors along the hinge, outwards, for the panels of the flap and
    zeros elsewhere. Raises ValueError for fewer strips or panels than there are parts to share them.
    """
    outline = _Outline(surface, vertical)
    stations = outline.stations(spanwise, flap.span if flap else ())
    edges = _chordwise_edges(chordwise, flap.hinge if flap else 0.0)
    leading, chord = outline.leading_edge(stations), outline.chord(stations)
    angle = outline.angle(0.5 * (stations[1:] + stations[:-1]))
    x_axis = np.array([1.0, 0.0, 0.0])

    def points(fractions: Array) -> Array:
        """(strip edges, fractions, 3)."""
        found: Array = leading[:, None] + (chord[:, None] * fractions)[..., None] * x_axis
        return found

    width = np.diff(edges)
    quarter, three_quarters = points(edges[:-1] + 0.25 * width), points(edges[:-1] + 0.75 * width)
    start, end = quarter[:-1], quarter[1:]
    across = leading[1:] - leading[:-1]
    across[:, 0] = 0.0
    across /= np.linalg.norm(across, axis=1)[:, None]
    flat = np.cross(x_axis, across)
    # turned about the strip's own axis, leading edge up
    normal = np.cos(angle)[:, None] * flat + np.sin(angle)[:, None] * np.cross(across, flat)
    grid = points(edges)
    corners = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=2)
    count = spanwise * chordwise
    axes = np.zeros((spanwise, chordwise, 3))
    if flap is not None:
        line = points(np.array([flap.hinge]))[:, 0]
        direction = (line[1:] - line[:-1]) / np.linalg.norm(line[1:] - line[:-1], axis=1)[:, None]
        along = outline.span_fraction(0.5 * (stations[1:] + stations[:-1]))
        strips = (along > flap.span[0]) & (along < flap.span[1])
        behind = edges[:-1] > flap.hinge - _ROUNDING
        axes[np.ix_(strips, behind)] = direction[strips, None]
    lattice = Lattice(
        start=start.reshape(count, 3),
        end=end.reshape(count, 3),
        control=(0.5 * (three_quarters[:-1] + three_quarters[1:])).reshape(count, 3),
        normal=np.repeat(normal, chordwise, axis=0),
        hinge=np.zeros((count, CONTROLS, 3)),
        corners=corners.reshape(count, 4, 3),
        surface=np.zeros(count, dtype=np.int64),
        surfaces=(name,),
    )
    return lattice, axes.reshape(count, 3)


class _Outline(Planform):
    """A planform cut into strips, and the angle of its chords."""

    def __init__(self, surface: Surface, vertical: bool) -> None:
        super().__init__(surface, vertical)
        self._surface = surface
        self._fractions = self.spans / self.spans[-1]

    def stations(self, strips: int, breaks: Sequence[float]) -> Array:
        """Edges (strips + 1,) of the strips along the length."""
        inner = np.interp(np.asarray(breaks, dtype=np.float64), self._fractions, self.ends)
        parts = np.sort(np.concatenate([self.ends, inner]))
        parts = parts[np.concatenate([[True], np.diff(parts) > _ROUNDING])]
        lengths = np.diff(parts)
        if strips < len(lengths):
            raise ValueError(f"{strips} strips for {len(lengths)} parts of the span; give at least one each")
        counts = np.ones(len(lengths), dtype=np.int64)
        for _ in range(strips - len(lengths)):
            counts[np.argmax(lengths / counts)] += 1
        pieces = [
            np.linspace(a, b, n, endpoint=False) for (a, b), n in zip(pairwise(parts), counts, strict=True)
        ]
        return np.concatenate([*pieces, parts[-1:]])

    def span_fraction(self, stations: Array) -> Array:
        """Fraction of the semi-span at lengths `stations` (k,)."""
        fraction: Array = np.interp(stations, self.ends, self._fractions)
        return fraction

    def angle(self, stations: Array) -> Array:
        """Angle (k,) [rad] of the chord at lengths `stations` (k,): incidence and twist."""
        sections = self._surface.sections
        # a twist may jump where a chord may not
        place = np.clip(np.searchsorted(self.ends, stations, side="right") - 1, 0, len(sections) - 1)
        along = (stations - self.ends[place]) / np.diff(self.ends)[place]
        first = np.array([section.twist_deg[0] for section in sections])[place]
        last = np.array([section.twist_deg[1] for section in sections])[place]
        turned: Array = np.radians(self._surface.incidence_deg + first + along * (last - first))
        return turned


def _chordwise_edges(count: int, hinge: float) -> Array:
    if not 0.0 < hinge < 1.0:
        return np.linspace(0.0, 1.0, count + 1)
    if count < 2:
        raise ValueError("a hinge needs two panels along the chord, one on either side")
    behind = min(max(round(count * (1.0 - hinge)), 1), count - 1)
    ahead = np.linspace(0.0, hinge, count - behind, endpoint=False)
    return np.concatenate([ahead, np.linspace(hinge, 1.0, behind + 1)])


INCIDENCE, ELEVATOR_LEFT, ELEVATOR_RIGHT, AILERON_LEFT, AILERON_RIGHT, RUDDER = range(CONTROLS)


def airliner_lattice(aircraft: Aircraft, counts: PanelCounts | None = None) -> Lattice:
    """The lattice of `aircraft`: right and left wing, right and left horizontal tail, vertical tail.

    Raises ValueError where a surface has fewer strips than sections and control surfaces ask for.
    """
    counts = counts or PanelCounts()
    surfaces, controls = aircraft.surfaces, aircraft.control_surfaces
    flaps: dict[str, tuple[ControlSurface, int, int]] = {}
    for flap, left, right in (
        (controls.elevator, ELEVATOR_LEFT, ELEVATOR_RIGHT),
        (controls.aileron, AILERON_LEFT, AILERON_RIGHT),
        (controls.rudder, RUDDER, RUDDER),
    ):
        flaps[flap.surface] = (flap, left, right)
    parts = [
        *_both_halves(surfaces.wing, "wing", counts.wing, flaps.get("wing")),
        *_both_halves(
            surfaces.horizontal_tail, "horizontal_tail", counts.horizontal_tail, flaps.get("horizontal_tail")
        ),
    ]
    name = "vertical_tail"
    rudder = flaps[name][0] if name in flaps else None
    tail, axes = panel(surfaces.vertical_tail, name, *counts.vertical_tail, vertical=True, flap=rudder)
    if rudder is not None:
        tail.hinge[:, RUDDER] = -axes  # about the upward hinge a positive turn moves the trailing edge right
    lattice = Lattice.joined([*parts, tail])
    turned = lattice.surface == lattice.surfaces.index(controls.trimmed_surface)
    lattice.hinge[turned, INCIDENCE] = (0.0, 1.0, 0.0)
    return lattice


def _both_halves(
    surface: Surface, name: str, counts: tuple[int, int], flap: tuple[ControlSurface, int, int] | None
) -> tuple[Lattice, Lattice]:
    right, axes = panel(surface, name, *counts, flap=flap[0] if flap else None)
    left = right.mirrored()
    if flap is not None:
        _, on_the_left, on_the_right = flap
        right.hinge[:, on_the_right] = axes
        left.hinge[:, on_the_left] = _mirrored_axis(axes)
    return right, left


def _mirrored_axis(axes: Array) -> Array:
    """An axis of rotation is an axial vector: what it turns downwards its image turns downwards too."""
    return np.where(axes == 0.0, 0.0, -axes * MIRROR)
