"""How the points of a lifting surface move in an elastic mode: rigid arms from the elastic axis."""

import numpy as np

from flexsurr.flight.beam_element import BeamElement
from flexsurr.flight.modes import FreeModes
from flexsurr.flight.stick_model import LEFT, RIGHT
from flexsurr.simulation.rhs import Array


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
