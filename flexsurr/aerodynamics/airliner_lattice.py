"""The lattice of the airliner: wing and tails, with the axes about which its controls turn the normals."""

import numpy as np

from flexsurr.aerodynamics.features import CONTROLS
from flexsurr.aerodynamics.lattice import MIRROR, Lattice, panel
from flexsurr.config.aircraft import Aircraft, ControlSurface, Surface
from flexsurr.config.panels import PanelCounts
from flexsurr.simulation.rhs import Array

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
