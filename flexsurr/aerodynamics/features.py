"""What every form of the aerodynamics takes and gives: 25 inputs, 12 outputs, always in this order.

Geometry (lattice, modes, centre of gravity) is in geometry axes: x aft from the nose, y right, z up.
Inputs, side force and moments are in body axes: x forward, y right, z down, origin at the centre of gravity;
lift and drag in stability axes, body axes turned by α about y (`flexsurr.aerodynamics.forces`).
Names in brackets are the paper's (its section 5).

Inputs

    mach             (M) V over the local speed of sound
    altitude_m       (h) of the standard atmosphere; acts through the Reynolds number alone
    alpha, beta      [rad]; (u, v, w) = V (cos α cos β, sin β, sin α cos β) is the velocity of the centre of
                     gravity through the air, in body axes
    p_over_V, q_over_V, r_over_V
                     (p/V, q/V, r/V) [rad/m] body rates over the airspeed V
    i_t              [rad] all of the horizontal tail, positive leading edge up
    delta_e_left, delta_e_right, delta_a_left, delta_a_right
                     (δ_e,L, δ_e,R, δ_a,L, δ_a,R) [rad] positive trailing edge down, on either side: an
                     elevator of both turns the nose down, an aileron deflection to roll right (p > 0)
                     is left positive, right negative
    delta_r          (δ_r) [rad] positive trailing edge left: turns the nose left (C_n < 0)
    eta_1 … eta_6    (η) [kg^½ m] amplitudes of the chosen elastic modes (mass-normalised)
    eta_dot_1_over_V … eta_dot_6_over_V
                     (η̇/V) [kg^½] their rates over the airspeed

Outputs

    C_L, C_D         lift and drag over q̄ S in stability axes: drag along the airspeed's projection on the
                     plane of symmetry, lift perpendicular to it in that plane; parasite drag is in
    C_Y              side force over q̄ S along the body's y axis, positive to the right
    C_m, C_l, C_n    pitching, rolling and yawing moment about the body's axes through the centre of gravity,
                     over q̄ S c, q̄ S b, q̄ S b
    C_phi_1 … C_phi_6
                     (C_φ) [kg^-½] generalised force of each mode over q̄ S: Σ F · Φ / (q̄ S), so that
                     η̈ + 2ζωη̇ + ω²η = q̄ S C_φ for mass-normalised Φ [kg^-½]

with q̄ = ½ ρ V², S the reference area, b the span, c the reference chord.
"""

from typing import NamedTuple, TypeVar

import numpy as np

Speed = TypeVar("Speed", float, np.ndarray)

MODES = 6
CONTROLS = 6


class ReferenceDimensions(NamedTuple):
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
    "C_L",
    "C_D",
    "C_Y",
    "C_m",
    "C_l",
    "C_n",
    *(f"C_phi_{k}" for k in range(1, MODES + 1)),
)
COEFFICIENT_UNITS: tuple[str, ...] = ("1",) * 6 + ("kg^-0.5",) * MODES

MACH, ALTITUDE, ALPHA, BETA, RATE_P, RATE_Q, RATE_R, INCIDENCE = range(8)
FIRST_CONTROL = 7
FIRST_ETA = FIRST_CONTROL + CONTROLS
FIRST_ETA_RATE = FIRST_ETA + MODES

LIFT, DRAG, SIDE, PITCH, ROLL, YAW, FIRST_MODAL = range(7)

# The four groups that the earlier work gave a network each: drag, longitudinal, lateral-directional, modal.
OUTPUT_GROUPS: dict[str, tuple[str, ...]] = {
    "drag": ("C_D",),
    "longitudinal": ("C_L", "C_m"),
    "lateral": ("C_Y", "C_l", "C_n"),
    "modal": COEFFICIENTS[FIRST_MODAL:],
}

# Pairs of features whose products are the second-order terms of a network that has them as further inputs:
# the onset's angles with each other and with each modal coordinate and velocity.
SECOND_ORDER: tuple[tuple[int, int], ...] = (
    (ALPHA, ALPHA),
    (ALPHA, BETA),
    (BETA, BETA),
    *((angle, modal) for angle in (ALPHA, BETA) for modal in range(FIRST_ETA, len(FEATURES))),
)


def onset_angles(u: Speed, v: Speed, w: Speed) -> tuple[Speed, Speed, Speed]:
    """Airspeed, and α and β [rad], of the velocity (u, v, w) through the air in body axes: as defined above.

    Numbers or arrays; numba compiles it as it is.
    """
    airspeed = np.sqrt(u * u + v * v + w * w)
    return airspeed, np.arctan2(w, u), np.arcsin(v / airspeed)
