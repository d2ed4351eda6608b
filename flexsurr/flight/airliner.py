"""The airliner as the aerodynamics sees it: its lattice, carried by the chosen elastic modes.

Points of a lifting surface move by rigid arms from its elastic axis.
"""

from collections.abc import Sequence

import numpy as np

from flexsurr.aerodynamics.airframe import Airframe, ModalMotion, airframe_of
from flexsurr.aerodynamics.lattice import Lattice, airliner_lattice
from flexsurr.config.aerodynamics import PanelCounts
from flexsurr.flight.modes import FreeModes
from flexsurr.flight.skeleton import BeamElement
from flexsurr.flight.stick_model import LEFT, RIGHT
from flexsurr.simulation.rhs import Array

DEFAULT_MODES = (1, 2, 5, 6, 7, 8)
"""The elastic modes that the aerodynamics knows, counted from 1; the paper leaves out two of the eight."""


def modal_motion(modes: FreeModes, lattice: Lattice, chosen: Sequence[int] = DEFAULT_MODES) -> ModalMotion:
    """How the panels of `lattice` move with the modes of the numbers `chosen` (from 1).

    Raises ValueError for a mode that `modes` does not hold.
    """
    most = len(modes.omega_rad_s)
    for number in chosen:
        if not 1 <= number <= most:
            raise ValueError(f"chosen: mode {number} is not allowed; allowed: 1 to {most}")
    columns = np.array(chosen, dtype=np.int64) - 1
    motions = []
    for points in (lattice.control, lattice.bound):
        translation = np.zeros((len(lattice), 3, len(columns)))
        rotation = np.zeros((len(lattice), 3, len(columns)))
        for place, surface in enumerate(lattice.surfaces):
            here = lattice.surface == place
            moved, turned = surface_motion(modes, surface, points[here])
            translation[here] = moved[columns].transpose(2, 1, 0)
            rotation[here] = turned[columns].transpose(2, 1, 0)
        motions.append((translation, rotation))
    (translation, rotation), (bound_translation, _) = motions
    return ModalMotion(translation, rotation, bound_translation)


def flexible_airframe(
    modes: FreeModes, counts: PanelCounts | None = None, chosen: Sequence[int] = DEFAULT_MODES
) -> Airframe:
    """The airframe of the modes' aircraft, its centre of gravity that of the stick model."""
    aircraft = modes.model.aircraft
    lattice = airliner_lattice(aircraft, counts)
    x, y, z = (float(value) for value in modes.properties.centre_of_gravity)
    return airframe_of(aircraft, lattice, modal_motion(modes, lattice, chosen), (x, y, z))


def surface_motion(modes: FreeModes, surface: str, points: Array) -> tuple[Array, Array]:
    """Translation (k, 3, m) [kg^-½] and rotation (k, 3, m) [rad kg^-½ m⁻¹] of `points` (m, 3) in k modes.

    In geometry axes, for unit amplitudes. Sections parallel to the plane of symmetry stay rigid: a point
    goes with the point of the elastic axis at its own y (height, on the vertical tail), u + θ × (r − r_EA),
    u and θ linear along each element. Points beyond the beam's ends go with the nearest. Raises KeyError for
    a surface the aircraft has not.
    """
    points = np.asarray(points, dtype=np.float64)
    count = len(modes.omega_rad_s)
    translation = np.empty((count, 3, len(points)))
    rotation = np.empty((count, 3, len(points)))
    two_sided = (surface, LEFT) in modes.model.lines
    for side in (RIGHT, LEFT) if two_sided else (RIGHT,):
        chosen = np.ones(len(points), dtype=bool)
        if two_sided:
            chosen = points[:, 1] >= 0.0 if side == RIGHT else points[:, 1] < 0.0
        if not chosen.any():
            continue
        elements = modes.model.lines[surface, side]
        axis, displacements, rotations = _along(modes, elements)
        across = 1 if two_sided else 2
        stations, where = axis[:, across], points[chosen, across]
        arm = points[chosen].T - _interpolated(where, stations, axis)
        theta = _interpolated(where, stations, rotations)
        rotation[:, :, chosen] = theta
        translation[:, :, chosen] = _interpolated(where, stations, displacements) + np.cross(
            theta, arm[None], axis=1
        )
    return translation, rotation


def _interpolated(where: Array, stations: Array, values: Array) -> Array:
    """`values` (s, ...) given at `stations` (s,), linear in between, at `where` (m,): (..., m)."""
    order = np.argsort(stations)
    flat = values.reshape(len(values), -1)[order]
    columns = [np.interp(where, stations[order], column) for column in flat.T]
    return np.stack(columns).reshape(*values.shape[1:], len(where))


def _along(modes: FreeModes, elements: tuple[BeamElement, ...]) -> tuple[Array, Array, Array]:
    """Ends (s, 3) of a chain of elements, their displacement and rotation (s, k, 3) in each mode."""
    nodes = modes.model.skeleton.nodes
    count = len(modes.omega_rad_s)
    shapes = modes.shapes.reshape(len(nodes), 6, count)
    ends = [(elements[0].nodes[0], elements[0].ends[0])]
    ends += [(element.nodes[1], element.ends[1]) for element in elements]
    places = [node for node, _ in ends]
    axis = np.array([point for _, point in ends])
    rotations = shapes[places, 3:].transpose(0, 2, 1)
    arms = axis - nodes[places]
    displacements = shapes[places, :3].transpose(0, 2, 1) + np.cross(rotations, arms[:, None])
    return axis, displacements, rotations
