"""The airliner as the aerodynamics sees it: its lattice, carried by the chosen elastic modes."""

from collections.abc import Sequence

import numpy as np

from flexsurr.aerodynamics.airframe import Airframe, ModalMotion, airframe_of
from flexsurr.aerodynamics.airliner_lattice import airliner_lattice
from flexsurr.aerodynamics.lattice import Lattice
from flexsurr.config.panels import PanelCounts
from flexsurr.flight.modes import FreeModes
from flexsurr.flight.surface_motion import surface_motion

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
