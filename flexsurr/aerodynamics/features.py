"""What every form of the aerodynamics takes and gives: 25 inputs, 12 outputs, always in this order.

Geometry (lattice, modes, centre of gravity) is in geometry axes: x aft from the nose, y right, z up.
Inputs and outputs are in body axes: x forward, y right, z down, origin at the centre of gravity.

Inputs

    mach             V over the local speed of sound
    altitude_m       of the standard atmosphere; acts through the Reynolds number alone
    alpha, beta      [rad]; (u, v, w) = V (cos α cos β, sin β, sin α cos β) is the velocity of the centre of
                     gravity through the air, in body axes
    p/V, q/V, r/V    [rad/m] body rates over the airspeed V
    i_t              [rad] all of the horizontal tail, positive leading edge up
    delta_e left, right; delta_a left, right
                     [rad] positive trailing edge down, on either side: an elevator of both turns the nose
                     down, an aileron deflection to roll right (p > 0) is left positive, right negative
    delta_r          [rad] positive trailing edge left: turns the nose left (C_n < 0)
    eta_1 … eta_6    [kg^½ m] amplitudes of the chosen elastic modes (mass-normalised)
    eta_dot/V        [kg^½] their rates over the airspeed

Outputs

    C_X, C_Y, C_Z    force over q̄ S, in body axes: lift is −C_Z at α = 0, drag −C_X; parasite drag is in
    C_l, C_m, C_n    moment about the centre of gravity over q̄ S b, q̄ S c, q̄ S b
    C_Q1 … C_Q6      [kg^-½] generalised force of each mode over q̄ S: Σ F · Φ / (q̄ S), so that
                     η̈ + 2ζωη̇ + ω²η = q̄ S C_Q for mass-normalised Φ [kg^-½]

with q̄ = ½ ρ V², S the reference area, b the span, c the reference chord.
"""

from typing import NamedTuple

MODES = 6
CONTROLS = 6


class Reference(NamedTuple):
    """Reference area [m²], chord [m] and span [m] of the coefficients."""

    area: float
    chord: float
    span: float


FEATURES: tuple[str, ...] = (
    "mach",
    "altitude_m",
    "alpha",
    "beta",
    "p_over_V",
    "q_over_V",
    "r_over_V",
    "i_t",
    "delta_e_left",
    "delta_e_right",
    "delta_a_left",
    "delta_a_right",
    "delta_r",
    *(f"eta_{k}" for k in range(1, MODES + 1)),
    *(f"eta_dot_{k}_over_V" for k in range(1, MODES + 1)),
)
FEATURE_UNITS: tuple[str, ...] = (
    ("1", "m", "rad", "rad", "rad/m", "rad/m", "rad/m")
    + ("rad",) * CONTROLS
    + ("kg^0.5 m",) * MODES
    + ("kg^0.5",) * MODES
)
COEFFICIENTS: tuple[str, ...] = (
    "C_X",
    "C_Y",
    "C_Z",
    "C_l",
    "C_m",
    "C_n",
    *(f"C_Q{k}" for k in range(1, MODES + 1)),
)
COEFFICIENT_UNITS: tuple[str, ...] = ("1",) * 6 + ("kg^-0.5",) * MODES

MACH, ALTITUDE, ALPHA, BETA, RATE_P, RATE_Q, RATE_R, INCIDENCE = range(8)
FIRST_CONTROL = 7
FIRST_ETA = FIRST_CONTROL + CONTROLS
FIRST_ETA_RATE = FIRST_ETA + MODES
