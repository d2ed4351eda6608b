"""Parasite drag that depends on the Reynolds number, which makes altitude a live input.

The given coefficient holds at the design point; elsewhere it follows the skin friction of a turbulent flat
plate, 0.455 / (log₁₀ Re)^2.58 / (1 + 0.144 M²)^0.65 (Raymer, *Aircraft Design*, eq. 12.27).
"""

import math

from numba import njit

from flexsurr.aerodynamics.standard_atmosphere import CACHED, density, speed_of_sound, viscosity

# Where a transport's drag is quoted: in cruise.
DESIGN_MACH = 0.7
DESIGN_ALTITUDE = 10000.0  # m


@njit(**CACHED)
def friction(mach, altitude, length):
    """Skin friction coefficient of a plate of `length` [m] at `altitude` [m]."""
    reynolds = density(altitude) * mach * speed_of_sound(altitude) * length / viscosity(altitude)
    return 0.455 / (math.log10(reynolds) ** 2.58 * (1.0 + 0.144 * mach * mach) ** 0.65)


@njit(**CACHED)
def parasite_drag(at_design_point, mach, altitude, chord):
    """C_D0 at `mach` and `altitude` [m], from that at the design point and the reference chord [m]."""
    ratio = friction(mach, altitude, chord) / friction(DESIGN_MACH, DESIGN_ALTITUDE, chord)
    return at_design_point * ratio
