"""From circulations to the twelve coefficients: forces in body axes, parasite drag, stability axes.

Kutta–Joukowski's forces, the body's and the parasite drag are summed in body axes, in the order X, Y, Z, l,
m, n. What comes out, and what equations of motion take, is lift, drag, side force, then pitching, rolling and
yawing moment. Lift and drag are in stability axes, body axes turned by α about the y axis:

    C_L =  C_X sin α − C_Z cos α        C_X = C_L sin α − C_D cos α
    C_D = −C_X cos α − C_Z sin α        C_Z = −C_L cos α − C_D sin α

The two are the same reflection, so one function serves both ways. Side force and moments stay in body axes.

Parasite drag depends on the Reynolds number, which makes altitude a live input. The given coefficient holds
at the design point; elsewhere it follows the skin friction of a turbulent flat plate, 0.455 / (log₁₀ Re)^2.58
/ (1 + 0.144 M²)^0.65 (Raymer, *Aircraft Design*, eq. 12.27).
"""

import math

from numba import njit

from flexsurr.aerodynamics.boundary import COMPILED, local_onset, onset
from flexsurr.aerodynamics.features import (
    ALPHA,
    ALTITUDE,
    DRAG,
    FIRST_MODAL,
    LIFT,
    MACH,
    MODES,
    PITCH,
    ROLL,
    SIDE,
    YAW,
)
from flexsurr.aerodynamics.standard_atmosphere import CACHED, density, speed_of_sound, viscosity

# Places of sums in body axes.
BODY_X, BODY_Y, BODY_Z, BODY_L, BODY_M, BODY_N = range(6)


@njit(**COMPILED)
def reflected(sine, cosine, first, second):
    """(C_X, C_Z) of (C_L, C_D), or (C_L, C_D) of (C_X, C_Z), by the sine and cosine of α."""
    return sine * first - cosine * second, -cosine * first - sine * second


@njit(**COMPILED)
def name_coefficients(u, y):
    """Replace the sums in body axes in `y` (12,) by the coefficients at the features `u` (25,)."""
    lift, drag = reflected(math.sin(u[ALPHA]), math.cos(u[ALPHA]), y[BODY_X], y[BODY_Z])
    side, roll, pitch, yaw = y[BODY_Y], y[BODY_L], y[BODY_M], y[BODY_N]
    y[LIFT], y[DRAG], y[SIDE] = lift, drag, side
    y[PITCH], y[ROLL], y[YAW] = pitch, roll, yaw


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


@njit(**COMPILED)
def add_vortex_force(far, panels, u, i, gamma, vx, vy, vz, y):
    """Add to the sums `y` (12,) the force on bound vortex i of circulation `gamma` [m] (over V).

    (vx, vy, vz) [m] is the velocity induced at its middle, over V, times the circulation; so both may be sums
    over several Mach numbers. `far` is the onset. Induced drag comes out directly, since the force is square
    to the local velocity.
    """
    ox, oy, oz = local_onset(far, u, panels.bound, panels.bound_shift, i)
    vx += gamma * ox
    vy += gamma * oy
    vz += gamma * oz
    lx, ly, lz = panels.vortex[i, 0], panels.vortex[i, 1], panels.vortex[i, 2]
    scale = 2.0 / panels.area
    fx = scale * (vy * lz - vz * ly)
    fy = scale * (vz * lx - vx * lz)
    fz = scale * (vx * ly - vy * lx)
    rx, ry, rz = panels.bound[i, 0], panels.bound[i, 1], panels.bound[i, 2]
    # from geometry to body axes: x and z change their signs
    y[BODY_X] -= fx
    y[BODY_Y] += fy
    y[BODY_Z] -= fz
    y[BODY_L] -= (ry * fz - rz * fy) / panels.span
    y[BODY_M] += (rz * fx - rx * fz) / panels.chord
    y[BODY_N] -= (rx * fy - ry * fx) / panels.span
    for k in range(MODES):
        y[FIRST_MODAL + k] += (
            fx * panels.bound_shift[i, k, 0]
            + fy * panels.bound_shift[i, k, 1]
            + fz * panels.bound_shift[i, k, 2]
        )


@njit(**COMPILED)
def add_body(exact, panels, u, y):
    """Add to the sums `y` (12,) the parasite drag and the fuselage's moment.

    The drag is along the onset at the centre of gravity, the moment ρ munk_volume (0, u w, −u v) in body
    axes: first order in α and β where the boundary condition is.
    """
    vx, vy, vz = onset(exact, u)
    drag = parasite_drag(panels.parasite_drag_coefficient, u[MACH], u[ALTITUDE], panels.chord)
    y[BODY_X] -= drag * vx
    y[BODY_Y] += drag * vy
    y[BODY_Z] -= drag * vz
    moment = 2.0 * panels.munk_volume / panels.area * vx
    y[BODY_M] += moment * vz / panels.chord
    y[BODY_N] += moment * vy / panels.span
