"""The flexible airliner in flight: stick model and modes, equations of motion, trim, linearisation."""

from flexsurr.flight.modes import FreeModes, free_modes
from flexsurr.flight.skeleton import MassProperties, mass_properties
from flexsurr.flight.stick_model import StickModel, stick_model
from flexsurr.flight.surface_motion import surface_motion

__all__ = [
    "FreeModes",
    "MassProperties",
    "StickModel",
    "free_modes",
    "mass_properties",
    "stick_model",
    "surface_motion",
]
