"""The stick model of an aircraft: beams along its elastic axes, their connections, and its masses.

Geometry axes: x aft from the nose, y to the right, z up. The wing's and the horizontal tail's connections
run level from the plane of symmetry to the first node of either half, carried there by a rigid arm from the
fuselage; the vertical tail's rises from the fuselage. The published data do not say how; these choices, and
the pylon's geometry, bring the frequencies to those of the aircraft.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from flexsurr.config.aircraft import Aircraft
from flexsurr.config.aircraft_structure import BeamStiffness
from flexsurr.flight.mass_distribution import SurfaceLine, engine_mass, fuselage_masses, surface_masses
from flexsurr.flight.skeleton import BeamElement, LumpedMass, Section, Skeleton
from flexsurr.simulation.rhs import Array

_UP = (0.0, 0.0, 1.0)
_SIDEWAYS = (0.0, 1.0, 0.0)
_AFT = (1.0, 0.0, 0.0)
RIGHT, LEFT = "right", "left"


@dataclass(frozen=True, eq=False)
class StickModel:
    """A skeleton, and which of its elements carry each lifting surface.

    `lines` leads from (surface, side) to the elements from the root outwards; the vertical tail's side is
    "right". `engines` are the places of the two engines' nodes, right and left.
    """

    aircraft: Aircraft
    skeleton: Skeleton
    lines: dict[tuple[str, str], tuple[BeamElement, ...]]
    engines: tuple[int, int]


class _Builder:
    def __init__(self) -> None:
        self.nodes: list[Array] = []
        self.elements: list[BeamElement] = []
        self.masses: list[LumpedMass] = []

    def node(self, x: float, y: float, z: float) -> int:
        self.nodes.append(np.array([x, y, z]))
        return len(self.nodes) - 1

    def beam(
        self,
        first: int,
        second: int,
        section: Section,
        normal: tuple[float, float, float],
        begin: Array | None = None,
    ) -> BeamElement:
        """An element between two nodes; `begin` where its first end is not at the first node itself."""
        ends = np.array([self.nodes[first] if begin is None else begin, self.nodes[second]])
        element = BeamElement((first, second), ends, section, normal)
        self.elements.append(element)
        return element


def stick_model(aircraft: Aircraft) -> StickModel:
    """The stick model of `aircraft`. Raises ValueError where an elastic axis does not fit its beam."""
    build = _Builder()
    surfaces, connections = aircraft.surfaces, aircraft.stiffness.connections
    wing = SurfaceLine(surfaces.wing)
    horizontal = SurfaceLine(surfaces.horizontal_tail)
    vertical = SurfaceLine(surfaces.vertical_tail, vertical=True)
    roots = [float(line.elastic_axis(np.array([line.start]))[0, 0]) for line in (wing, horizontal, vertical)]
    at_wing, at_horizontal, at_vertical = _fuselage(build, aircraft, roots)
    lines: dict[tuple[str, str], tuple[BeamElement, ...]] = {}
    engines = []
    parts = aircraft.mass
    crank = float(wing.ends[-2])
    for side, sign in ((RIGHT, 1.0), (LEFT, -1.0)):
        left = sign < 0.0
        hung = wing.length_at(parts.engine.y_m)
        stations, sections = _stations(
            [
                (wing.start, crank, aircraft.stiffness.wing_side_of_body_to_crank),
                (crank, wing.end, aircraft.stiffness.wing_crank_to_tip),
            ],
            hung,
        )
        nodes, elements = _surface(build, wing, stations, sections, sign, _UP)
        root = _level_connection(build, at_wing, nodes[0], connections.wing_to_fuselage.value)
        lines["wing", side] = (root, *elements)
        for mass, part, up_to in (
            (parts.wing_structure_kg, "wing structure", 1.0),
            (parts.fuel_kg, "fuel", parts.fuel_to_semi_span),
        ):
            build.masses += surface_masses(
                aircraft, wing, stations, nodes, 0.5 * mass, part, up_to=up_to, left=left
            )
        engines.append(_engine(build, aircraft, nodes[stations.index(hung)]))
        stations, sections = _stations(
            [(horizontal.start, horizontal.end, aircraft.stiffness.horizontal_tail)]
        )
        nodes, elements = _surface(build, horizontal, stations, sections, sign, _UP)
        root = _level_connection(
            build, at_horizontal, nodes[0], connections.horizontal_tail_to_fuselage.value
        )
        lines["horizontal_tail", side] = (root, *elements)
        mass = 0.5 * parts.horizontal_tail_kg
        build.masses += surface_masses(
            aircraft, horizontal, stations, nodes, mass, "horizontal tail", left=left
        )
    stations, sections = _stations([(vertical.start, vertical.end, aircraft.stiffness.vertical_tail)])
    nodes, elements = _surface(build, vertical, stations, sections, 1.0, _SIDEWAYS)
    root = build.beam(at_vertical, nodes[0], connections.vertical_tail_to_fuselage.value, _SIDEWAYS)
    lines["vertical_tail", RIGHT] = (root, *elements)
    mass = parts.vertical_tail_kg
    build.masses += surface_masses(aircraft, vertical, stations, nodes, mass, "vertical tail")
    skeleton = Skeleton(np.array(build.nodes), tuple(build.elements), tuple(build.masses))
    return StickModel(aircraft, skeleton, lines, (engines[0], engines[1]))


def _fuselage(build: _Builder, aircraft: Aircraft, extra: list[float]) -> list[int]:
    """The fuselage's beam; the nodes at the places `extra` [m], which split the elements they fall into."""
    stiffness = aircraft.stiffness.fuselage
    stations, sections = _stations([(0.0, aircraft.published.fuselage_length_m, stiffness)], *extra)
    height = aircraft.fuselage.axis_z_m
    nodes = [build.node(x, 0.0, height) for x in stations]
    for first, second, section in zip(nodes, nodes[1:], sections, strict=False):
        build.beam(first, second, section, _UP)
    build.masses += fuselage_masses(aircraft, stations, nodes)
    return [nodes[stations.index(x)] for x in extra]


def _stations(
    beams: list[tuple[float, float, BeamStiffness]], *extra: float
) -> tuple[list[float], list[Section]]:
    """Ends of all elements of consecutive beams (begin, end, stiffness), and the section of each element."""
    edges: list[float] = [beams[0][0]]
    sections: list[Section] = []
    for begin, end, stiffness in beams:
        inner = np.linspace(begin, end, stiffness.elements + 1)[1:]
        edges += [float(edge) for edge in inner]
        sections += stiffness.values
    stations = sorted({*edges, *extra})
    middles = [0.5 * (a + b) for a, b in pairwise(stations)]
    return stations, [sections[int(np.searchsorted(edges, middle)) - 1] for middle in middles]


def _surface(
    build: _Builder,
    line: SurfaceLine,
    stations: list[float],
    sections: list[Section],
    sign: float,
    normal: tuple[float, float, float],
) -> tuple[list[int], list[BeamElement]]:
    points = line.elastic_axis(np.array(stations)) * np.array([1.0, sign, 1.0])
    nodes = [build.node(*point) for point in points]
    pairs = zip(nodes, nodes[1:], sections, strict=False)
    return nodes, [build.beam(first, second, section, normal) for first, second, section in pairs]


def _level_connection(build: _Builder, fuselage: int, root: int, section: Section) -> BeamElement:
    begin = np.array([build.nodes[fuselage][0], 0.0, build.nodes[root][2]])
    return build.beam(fuselage, root, section, _UP, begin)


def _engine(build: _Builder, aircraft: Aircraft, wing: int) -> int:
    """Pylon, nacelle and engine below the node `wing`; the node of the engine."""
    engine, sections = aircraft.mass.engine, aircraft.stiffness.connections
    x, y, z = build.nodes[wing]
    forward, aft = engine.hangers_ahead_of_elastic_axis_m
    pylon = z - engine.pylon_below_elastic_axis_m
    axis = z - engine.below_elastic_axis_m
    top = build.node(x, y, pylon)
    pylon_aft, pylon_forward = build.node(x - aft, y, pylon), build.node(x - forward, y, pylon)
    nacelle_aft, nacelle_forward = build.node(x - aft, y, axis), build.node(x - forward, y, axis)
    centre = build.node(x - engine.ahead_of_elastic_axis_m, y, axis)
    build.beam(wing, top, sections.wing_to_pylon.value, _SIDEWAYS)
    build.beam(top, pylon_aft, sections.pylon.value, _UP)
    build.beam(pylon_aft, pylon_forward, sections.pylon.value, _UP)
    build.beam(pylon_aft, nacelle_aft, sections.pylon_to_nacelle_aft.value, _AFT)
    build.beam(pylon_forward, nacelle_forward, sections.pylon_to_nacelle_forward.value, _AFT)
    build.beam(nacelle_aft, centre, sections.nacelle.value, _UP)
    build.beam(centre, nacelle_forward, sections.nacelle.value, _UP)
    build.masses.append(engine_mass(aircraft, centre, build.nodes[centre]))
    return centre
