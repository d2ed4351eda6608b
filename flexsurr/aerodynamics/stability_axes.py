"""Between body axes, in which forces are summed, and the coefficients that the paper names.

The lattice sums forces and moments in body axes, in the order X, Y, Z, l, m, n. What it gives, and what
equations of motion take, is lift, drag, side force, then pitching, rolling and yawing moment. Lift and drag
are in stability axes, body axes turned by α about the y axis:

    C_L =  C_X sin α − C_Z cos α        C_X = C_L sin α − C_D cos α
    C_D = −C_X cos α − C_Z sin α        C_Z = −C_L cos α − C_D sin α

The two are the same reflection, so one function serves both ways. Side force and moments stay in body axes.
"""

import math

from numba import njit

from flexsurr.aerodynamics.boundary import COMPILED
from flexsurr.aerodynamics.features import ALPHA, DRAG, LIFT, PITCH, ROLL, SIDE, YAW

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
