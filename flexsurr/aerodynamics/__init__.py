"""The airliner's aerodynamics: a vortex lattice rebuilt, frozen, or reduced to its quadratic form."""

from flexsurr.aerodynamics.airframe import Airframe, ModalMotion, airframe_of
from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES, ReferenceDimensions
from flexsurr.aerodynamics.lattice import Lattice, airliner_lattice, panel
from flexsurr.aerodynamics.mach_grid import MachGrid, fixed_machs, mach_grid
from flexsurr.aerodynamics.quadratic import quadratic
from flexsurr.aerodynamics.vortex_lattice import frozen, rebuilt

__all__ = [
    "COEFFICIENTS",
    "FEATURES",
    "Airframe",
    "Lattice",
    "MachGrid",
    "ModalMotion",
    "ReferenceDimensions",
    "airframe_of",
    "airliner_lattice",
    "fixed_machs",
    "frozen",
    "mach_grid",
    "panel",
    "quadratic",
    "rebuilt",
]
