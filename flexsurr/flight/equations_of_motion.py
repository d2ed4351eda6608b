"""Equations of motion of a flexible aircraft in mean axes, compiled.

Source: M. R. Waszak, D. K. Schmidt, *Flight dynamics of aeroelastic vehicles*, J. Aircraft 25 (1988) 563–571.
In mean axes elastic motion carries neither momentum nor angular momentum; with the inertia of the
undeformed shape the rigid-body equations are those of a rigid aircraft, and only the aerodynamics couples
them with

    η̈ + 2 ζ ω η̇ + ω² η = Q .

Body axes: x forward, y right, z down, origin at the centre of gravity. Earth: north, east, and altitude
upwards, flat and at rest. Attitude: φ, θ, ψ in the order 3-2-1, singular at θ = ±90°. Uniform gravity does no
work in mean axes.
"""

import math
from typing import Any, NamedTuple

from numba import njit

from flexsurr.aerodynamics.boundary import COMPILED
from flexsurr.aerodynamics.features import (
    ALPHA,
    ALTITUDE,
    BETA,
    COEFFICIENTS,
    CONTROLS,
    DRAG,
    FEATURES,
    FIRST_CONTROL,
    FIRST_ETA,
    FIRST_ETA_RATE,
    FIRST_MODAL,
    LIFT,
    MACH,
    MODES,
    PITCH,
    RATE_P,
    ROLL,
    SIDE,
    YAW,
    onset_angles,
)
from flexsurr.aerodynamics.forces import reflected
from flexsurr.aerodynamics.standard_atmosphere import density, speed_of_sound
from flexsurr.simulation.mapping import mapping
from flexsurr.simulation.rhs import Array, implements_rhs

EARTH = ("north_m", "east_m", "altitude_m")
ATTITUDE = ("phi", "theta", "psi")
VELOCITY = ("u", "v", "w")
RATES = ("p", "q", "r")
RIGID_BODY = EARTH + ATTITUDE + VELOCITY + RATES
RIGID_STATES = len(RIGID_BODY)

# Places in x by the states' names. After them stand η of each elastic mode, then η̇ of each.
NORTH_M, EAST_M, ALTITUDE_M, PHI, THETA, PSI, U, V, W, P, Q, R = range(RIGID_STATES)
VELOCITY_IN_X, RATES_IN_X = slice(U, W + 1), slice(P, R + 1)


def state_names(modes: int) -> tuple[str, ...]:
    """Twelve rigid-body states, amplitudes η of the elastic modes (from 1), their rates."""
    numbers = range(1, modes + 1)
    return RIGID_BODY + tuple(f"eta_{k}" for k in numbers) + tuple(f"eta_dot_{k}" for k in numbers)


def state_units(modes: int) -> tuple[str, ...]:
    """Units in the order of `state_names`."""
    rigid = ("m",) * 3 + ("rad",) * 3 + ("m/s",) * 3 + ("rad/s",) * 3
    return rigid + ("kg^0.5 m",) * modes + ("kg^0.5 m/s",) * modes


INPUTS = len(FEATURES)
SCRATCH = INPUTS + len(COEFFICIENTS)

_onset_angles = njit(**COMPILED)(onset_angles)


class FlexibleAircraft(NamedTuple):
    """Constants of the equations, and the kernel of an aerodynamics: 25 features to 12 coefficients.

    `inertia` and its inverse (3, 3) in body axes; `omega_squared`, `damping` = 2 ζ ω, and `thrust_shape` (the
    generalised force of each mode for a unit of thrust), (k,). `places` (6,): which of the k modes each of
    the aerodynamics' is, −1 where it has none. `controls` (6,): their positions in trim; `command` (6,) is
    added to them from `times`[0] to [1] and taken from them from [1] to [2].
    """

    mass: float
    gravity: float
    area: float
    chord: float
    span: float
    inertia: Array
    inverse_inertia: Array
    omega_squared: Array
    damping: Array
    places: Array
    thrust: float
    thrust_height: float
    thrust_shape: Array
    controls: Array
    command: Array
    times: Array
    aerodynamics: Any


@njit(**COMPILED)
def write_features(kernel, t, x, features):
    """Write the 25 inputs of the aerodynamics at time `t` [s] and state `x` (d,) into `features` (25,)."""
    k_modes = kernel.omega_squared.size
    airspeed, alpha, beta = _onset_angles(x[U], x[V], x[W])
    over = 1.0 / airspeed
    features[MACH] = airspeed / speed_of_sound(x[ALTITUDE_M])
    features[ALTITUDE] = x[ALTITUDE_M]
    features[ALPHA] = alpha
    features[BETA] = beta
    for i in range(3):
        features[RATE_P + i] = x[P + i] * over
    sign = 0.0
    if kernel.times[0] <= t < kernel.times[1]:
        sign = 1.0
    elif kernel.times[1] <= t < kernel.times[2]:
        sign = -1.0
    for i in range(CONTROLS):
        features[FIRST_CONTROL + i] = kernel.controls[i] + sign * kernel.command[i]
    for i in range(MODES):
        place = int(kernel.places[i])
        features[FIRST_ETA + i] = x[RIGID_STATES + place] if place >= 0 else 0.0
        features[FIRST_ETA_RATE + i] = x[RIGID_STATES + k_modes + place] * over if place >= 0 else 0.0


@njit(**COMPILED)
def write_motion(kernel, x, coefficients, dx):
    """Write ẋ (d,) into `dx`, with the 12 coefficients given."""
    k_modes = kernel.omega_squared.size
    phi, theta, psi = x[PHI], x[THETA], x[PSI]
    u, v, w = x[U], x[V], x[W]
    p, q, r = x[P], x[Q], x[R]
    speed_squared = u * u + v * v + w * w
    pressure = 0.5 * density(x[ALTITUDE_M]) * speed_squared * kernel.area

    sin_phi, cos_phi = math.sin(phi), math.cos(phi)
    sin_theta, cos_theta = math.sin(theta), math.cos(theta)
    sin_psi, cos_psi = math.sin(psi), math.cos(psi)
    # kinematics
    dx[NORTH_M] = (
        cos_theta * cos_psi * u
        + (sin_phi * sin_theta * cos_psi - cos_phi * sin_psi) * v
        + (cos_phi * sin_theta * cos_psi + sin_phi * sin_psi) * w
    )
    dx[EAST_M] = (
        cos_theta * sin_psi * u
        + (sin_phi * sin_theta * sin_psi + cos_phi * cos_psi) * v
        + (cos_phi * sin_theta * sin_psi - sin_phi * cos_psi) * w
    )
    dx[ALTITUDE_M] = sin_theta * u - sin_phi * cos_theta * v - cos_phi * cos_theta * w
    turn = (q * sin_phi + r * cos_phi) / cos_theta
    dx[PHI] = p + turn * sin_theta
    dx[THETA] = q * cos_phi - r * sin_phi
    dx[PSI] = turn
    # forces
    per_mass = pressure / kernel.mass
    # α by its tangent w / u
    inclined = 1.0 / math.sqrt(u * u + w * w)
    c_x, c_z = reflected(w * inclined, u * inclined, coefficients[LIFT], coefficients[DRAG])
    g = kernel.gravity
    dx[U] = per_mass * c_x + kernel.thrust / kernel.mass - g * sin_theta - q * w + r * v
    dx[V] = per_mass * coefficients[SIDE] + g * cos_theta * sin_phi - r * u + p * w
    dx[W] = per_mass * c_z + g * cos_theta * cos_phi - p * v + q * u
    # moments
    inertia, inverse = kernel.inertia, kernel.inverse_inertia
    hx = inertia[0, 0] * p + inertia[0, 1] * q + inertia[0, 2] * r
    hy = inertia[1, 0] * p + inertia[1, 1] * q + inertia[1, 2] * r
    hz = inertia[2, 0] * p + inertia[2, 1] * q + inertia[2, 2] * r
    thrust_moment = kernel.thrust * kernel.thrust_height
    mx = pressure * kernel.span * coefficients[ROLL] - (q * hz - r * hy)
    my = pressure * kernel.chord * coefficients[PITCH] + thrust_moment - (r * hx - p * hz)
    mz = pressure * kernel.span * coefficients[YAW] - (p * hy - q * hx)
    for i in range(3):
        dx[P + i] = inverse[i, 0] * mx + inverse[i, 1] * my + inverse[i, 2] * mz
    # elastic modes
    for i in range(k_modes):
        eta, rate = x[RIGID_STATES + i], x[RIGID_STATES + k_modes + i]
        dx[RIGID_STATES + i] = rate
        dx[RIGID_STATES + k_modes + i] = (
            kernel.thrust * kernel.thrust_shape[i] - kernel.damping[i] * rate - kernel.omega_squared[i] * eta
        )
    for i in range(MODES):
        place = int(kernel.places[i])
        if place >= 0:
            dx[RIGID_STATES + k_modes + place] += pressure * coefficients[FIRST_MODAL + i]


@implements_rhs(FlexibleAircraft, inline=False)
def _motion(kernel, t, x, dx, work):
    # features, coefficients and the aerodynamics' own scratch share `work`
    features = work[0:INPUTS]
    coefficients = work[INPUTS:SCRATCH]
    write_features(kernel, t, x, features)
    mapping(kernel.aerodynamics, features, coefficients, work[SCRATCH:])
    write_motion(kernel, x, coefficients, dx)


@njit(cache=True, error_model="numpy")
def features_along(kernel, t, x, features):
    """`write_features` as a call from Python, row by row: `t` (m,), `x` (m, d), `features` (m, 25)."""
    for row in range(t.size):
        write_features(kernel, t[row], x[row], features[row])


@njit(cache=True, error_model="numpy")
def motion_with(kernel, x, coefficients, dx):
    """`write_motion` as a call from Python."""
    write_motion(kernel, x, coefficients, dx)
