"""The flexible airliner in flight: stick model and modes, equations of motion, trim, linearisation."""

from flexsurr.flight.airliner import surface_motion
from flexsurr.flight.modes import FreeModes, free_modes
from flexsurr.flight.skeleton import MassProperties, mass_properties
from flexsurr.flight.stick_model import StickModel, stick_model

__all__ = [
    "FreeModes",
    "MassProperties",
    "StickModel",
    "free_modes",
    "mass_properties",
    "stick_model",
    "surface_motion",
]
