"""International Standard Atmosphere (ISO 2533) to 20 km, for compiled code and for Python.

It stands on this floor because the Reynolds number needs it; flight takes it from here.
"""

import math

from numba import njit

from flexsurr.simulation.rhs import FLOATING_POINT

CACHED = {"cache": True, "fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False}

GRAVITY = 9.80665  # m/s²
GAS_CONSTANT = 287.05287  # J/(kg K)
HEAT_RATIO = 1.4
SEA_LEVEL_TEMPERATURE = 288.15  # K
SEA_LEVEL_PRESSURE = 101325.0  # Pa
LAPSE_RATE = 0.0065  # K/m
TROPOPAUSE = 11000.0  # m
TROPOPAUSE_TEMPERATURE = SEA_LEVEL_TEMPERATURE - LAPSE_RATE * TROPOPAUSE
_EXPONENT = GRAVITY / (GAS_CONSTANT * LAPSE_RATE)
_TROPOPAUSE_PRESSURE = SEA_LEVEL_PRESSURE * (TROPOPAUSE_TEMPERATURE / SEA_LEVEL_TEMPERATURE) ** _EXPONENT
# Sutherland's law as the U.S. Standard Atmosphere 1976 has it (its eq. 51).
_SUTHERLAND = 1.458e-6  # kg/(m s K^½)
_SUTHERLAND_TEMPERATURE = 110.4  # K


@njit(**CACHED)
def temperature(altitude):
    """Temperature [K] at the geopotential `altitude` [m]."""
    if altitude < TROPOPAUSE:
        return SEA_LEVEL_TEMPERATURE - LAPSE_RATE * altitude
    return TROPOPAUSE_TEMPERATURE


@njit(**CACHED)
def density(altitude):
    """Density [kg/m³] at the geopotential `altitude` [m]."""
    if altitude < TROPOPAUSE:
        t = SEA_LEVEL_TEMPERATURE - LAPSE_RATE * altitude
        return SEA_LEVEL_PRESSURE * (t / SEA_LEVEL_TEMPERATURE) ** _EXPONENT / (GAS_CONSTANT * t)
    fall = math.exp(-GRAVITY * (altitude - TROPOPAUSE) / (GAS_CONSTANT * TROPOPAUSE_TEMPERATURE))
    return _TROPOPAUSE_PRESSURE * fall / (GAS_CONSTANT * TROPOPAUSE_TEMPERATURE)


@njit(**CACHED)
def speed_of_sound(altitude):
    """Speed of sound [m/s] at the geopotential `altitude` [m]."""
    return math.sqrt(HEAT_RATIO * GAS_CONSTANT * temperature(altitude))


@njit(**CACHED)
def viscosity(altitude):
    """Dynamic viscosity [Pa s] at the geopotential `altitude` [m]."""
    t = temperature(altitude)
    return _SUTHERLAND * t * math.sqrt(t) / (t + _SUTHERLAND_TEMPERATURE)
