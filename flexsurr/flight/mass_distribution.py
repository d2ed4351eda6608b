"""What an aircraft weighs, cut into rigid bodies at the nodes of its beams, which follow elastic axes."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from flexsurr.aerodynamics.lattice import Planform
from flexsurr.config.aircraft import Aircraft, Surface
from flexsurr.flight.skeleton import LumpedMass
from flexsurr.simulation.rhs import Array


class SurfaceLine(Planform):
    """A planform with the elastic axis that its beam follows."""

    def __init__(self, surface: Surface, vertical: bool = False) -> None:
        super().__init__(surface, vertical)
        self.start = self.length_at(surface.beam_starts_at_m)
        self.end = float(self.ends[-1])
        axis = surface.elastic_axis
        stations = [self.start, *(length for length in self.ends if length > self.start + 1e-9)]
        self._axis_lengths = np.array(stations)
        self._axis = np.array(axis if len(axis) > 1 else axis * len(stations))

    def length_at(self, span: float) -> float:
        """Length at the span coordinate [m]: y, or height above the root of a vertical surface."""
        return float(np.interp(span, self.spans, self.ends))

    def at_chord_fraction(self, length: Array, fraction: Array | float) -> Array:
        """Points (m, 3) behind the leading edge by a fraction of the chord, along x."""
        leading = self.leading_edge(length)
        leading[..., 0] += fraction * self.chord(length)
        return leading

    def elastic_axis(self, length: Array) -> Array:
        """Points (m, 3) of the elastic axis; inboard of the beam it keeps its first fraction of the chord."""
        return self.at_chord_fraction(length, np.interp(length, self._axis_lengths, self._axis))


_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(6)
MIRROR = np.diag([1.0, -1.0, 1.0])


def _quadrature(breaks: Sequence[float]) -> tuple[Array, Array]:
    """Points and weights over pieces between increasing `breaks`."""
    pieces = [(a, b) for a, b in pairwise(breaks) if b > a]
    points = [0.5 * (a + b) + 0.5 * (b - a) * _POINTS for a, b in pieces]
    weights = [0.5 * (b - a) * _WEIGHTS for a, b in pieces]
    return np.concatenate(points), np.concatenate(weights)


def _shares(stations: Sequence[float], begin: float, end: float) -> list[tuple[float, float]]:
    """The piece of [begin, end] that each of the increasing `stations` is nearest to."""
    edges = [begin, *(0.5 * (a + b) for a, b in pairwise(stations)), end]
    return list(pairwise(edges))


def surface_masses(
    aircraft: Aircraft,
    line: SurfaceLine,
    stations: Sequence[float],
    nodes: Sequence[int],
    mass: float,
    part: str,
    *,
    up_to: float = 1.0,
    left: bool = False,
) -> list[LumpedMass]:
    """`mass` [kg] spread over one surface as its chord squared, from the root to a fraction of its span.

    Each strip is a body of its own at the node whose place along the surface is in `stations`; it has the
    spread of its sections about their centre of gravity (along the chord) and of these along the strip.
    """
    end = line.end * up_to

    def density(length: Array) -> Array:
        return line.chord(length) ** 2

    points, weights = _quadrature([b for b in line.ends if b < end] + [end])
    per_density = mass / float(weights @ density(points))
    masses = []
    for node, (low, high) in zip(nodes, _shares(stations, 0.0, line.end), strict=True):
        high = min(high, end)
        if high <= low:
            continue
        points, weights = _quadrature([low, *(b for b in line.ends if low < b < high), high])
        pieces = per_density * weights * density(points)
        strip = float(pieces.sum())
        centres = line.at_chord_fraction(points, aircraft.mass.section_centre_of_gravity)
        position = pieces @ centres / strip
        spread = np.einsum("p,pi,pj->ij", pieces, centres - position, centres - position)
        radius = aircraft.mass.section_radius_of_gyration * line.chord(points)
        spread[0, 0] += float(pieces @ radius**2)
        inertia = np.trace(spread) * np.eye(3) - spread
        if left:
            position, inertia = MIRROR @ position, MIRROR @ inertia @ MIRROR
        masses.append(LumpedMass(node, position, strip, inertia, part))
    return masses


def fuselage_masses(aircraft: Aircraft, stations: Sequence[float], nodes: Sequence[int]) -> list[LumpedMass]:
    """Shell and systems, payload and landing gear, at the nodes of the fuselage's axis."""
    parts = aircraft.mass
    length = aircraft.published.fuselage_length_m
    shell, payload = parts.fuselage_and_systems, parts.payload
    a = shell.taper
    b = a * (length - shell.centroid_x_m) / shell.centroid_x_m
    scale = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)) / length

    def shell_density(x: Array) -> Array:
        return shell.mass_kg * scale * (x / length) ** (a - 1.0) * (1.0 - x / length) ** (b - 1.0)

    def payload_density(x: Array) -> Array:
        return np.full_like(x, payload.mass_kg / (payload.x_m[1] - payload.x_m[0]))

    height = aircraft.fuselage.axis_z_m
    masses = []
    for node, share in zip(nodes, _shares(stations, 0.0, length), strict=True):
        shell_radius = 0.5 * aircraft.fuselage.diameter_m
        masses += _slice(node, share, shell_density, shell_radius, height, "fuselage and systems")
        inside = (max(share[0], payload.x_m[0]), min(share[1], payload.x_m[1]))
        masses += _slice(node, inside, payload_density, payload.radius_of_gyration_m, height, "payload")
    for gear, part in ((parts.main_gear, "main gear"), (parts.nose_gear, "nose gear")):
        nearest = int(np.argmin(np.abs(np.asarray(stations) - gear.x_m)))
        position = np.array([gear.x_m, 0.0, height])
        masses.append(LumpedMass(nodes[nearest], position, gear.mass_kg, np.zeros((3, 3)), part))
    # what quadrature leaves of the densities' steep ends
    total = sum(lump.mass for lump in masses if lump.part == "fuselage and systems")
    return [
        LumpedMass(m.node, m.position, m.mass * shell.mass_kg / total, m.inertia, m.part)
        if m.part == "fuselage and systems"
        else m
        for m in masses
    ]


def _slice(
    node: int,
    share: tuple[float, float],
    density: Callable[[Array], Array],
    radius: float,
    height: float,
    part: str,
) -> list[LumpedMass]:
    """A slice of a body of revolution; `radius` of gyration in roll."""
    if share[1] <= share[0]:
        return []
    points, weights = _quadrature(share)
    pieces = weights * density(points)
    mass = float(pieces.sum())
    centre = float(pieces @ points) / mass
    along = float(pieces @ (points - centre) ** 2)
    roll = mass * radius**2
    inertia = np.diag([roll, 0.5 * roll + along, 0.5 * roll + along])
    return [LumpedMass(node, np.array([centre, 0.0, height]), mass, inertia, part)]


def engine_mass(aircraft: Aircraft, node: int, position: Array) -> LumpedMass:
    """One engine: a solid cylinder along x."""
    engine = aircraft.mass.engine
    radius_squared = 0.25 * engine.diameter_m**2
    across = (3.0 * radius_squared + engine.length_m**2) / 12.0
    inertia = engine.mass_kg * np.diag([0.5 * radius_squared, across, across])
    return LumpedMass(node, position, engine.mass_kg, inertia, "engine")
