"""The boundary condition: the wash through the panels that the circulations have to undo.

Two forms of it. *exact*: the air's velocity with the sine and cosine of α and β, normals turned by the
controls through finite angles, everything multiplied out. *linear*: first order in all inputs. Elastic
motion turns a normal by Σ η θ × n and moves a panel with Σ η̇ Φ in both.
"""

import math
from typing import Literal

from numba import njit

from flexsurr.aerodynamics.features import (
    ALPHA,
    BETA,
    CONTROLS,
    FIRST_CONTROL,
    FIRST_ETA,
    FIRST_ETA_RATE,
    MODES,
    RATE_P,
    RATE_Q,
    RATE_R,
)
from flexsurr.simulation.rhs import FLOATING_POINT

# inlined: a call would copy the descriptors of all arrays of the airframe, for every panel
COMPILED = {"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False, "forceinline": True}

BoundaryCondition = Literal["exact", "linear"]


@njit(**COMPILED)
def onset(exact, u):
    """The air's velocity over V far from the airframe, in geometry axes."""
    alpha, beta = u[ALPHA], u[BETA]
    if exact:
        cosine = math.cos(beta)
        return math.cos(alpha) * cosine, -math.sin(beta), math.sin(alpha) * cosine
    return 1.0, -beta, alpha


@njit(**COMPILED)
def local_onset(far, u, point, shift, i):
    """The air's velocity over V against point i of `point` (N, 3), which moves; far away it is `far`."""
    x, y, z = point[i, 0], point[i, 1], point[i, 2]
    # minus Ω × r, with the body rates (−p, q, −r) in geometry axes
    a, b, c = -u[RATE_P], u[RATE_Q], -u[RATE_R]
    vx, vy, vz = far
    vx -= b * z - c * y
    vy -= c * x - a * z
    vz -= a * y - b * x
    for k in range(MODES):
        rate = u[FIRST_ETA_RATE + k]
        vx -= rate * shift[i, k, 0]
        vy -= rate * shift[i, k, 1]
        vz -= rate * shift[i, k, 2]
    return vx, vy, vz


@njit(**COMPILED)
def turned_normal(exact, panels, u, i):
    """The normal of panel i, turned by controls and modes."""
    nx, ny, nz = panels.normal[i, 0], panels.normal[i, 1], panels.normal[i, 2]
    tx, ty, tz = 0.0, 0.0, 0.0
    for k in range(CONTROLS):
        hx, hy, hz = panels.hinge[i, k, 0], panels.hinge[i, k, 1], panels.hinge[i, k, 2]
        if hx != 0.0 or hy != 0.0 or hz != 0.0:
            angle = u[FIRST_CONTROL + k]
            if exact:
                sine, cosine = math.sin(angle), math.cos(angle)
                along = (1.0 - cosine) * (hx * nx + hy * ny + hz * nz)
                nx, ny, nz = (
                    cosine * nx + sine * (hy * nz - hz * ny) + along * hx,
                    cosine * ny + sine * (hz * nx - hx * nz) + along * hy,
                    cosine * nz + sine * (hx * ny - hy * nx) + along * hz,
                )
            else:
                tx += angle * hx
                ty += angle * hy
                tz += angle * hz
    for k in range(MODES):
        eta = u[FIRST_ETA + k]
        tx += eta * panels.turn[i, k, 0]
        ty += eta * panels.turn[i, k, 1]
        tz += eta * panels.turn[i, k, 2]
    return nx + ty * nz - tz * ny, ny + tz * nx - tx * nz, nz + tx * ny - ty * nx


@njit(**COMPILED)
def normal_wash(exact, far, panels, u, i):
    """Velocity over V of the undisturbed air through panel i, along its normal; `far` is the onset."""
    vx, vy, vz = local_onset(far, u, panels.control, panels.shift, i)
    nx, ny, nz = turned_normal(exact, panels, u, i)
    if exact:
        return vx * nx + vy * ny + vz * nz
    # V · n to first order: the onset through the fixed normal, and (1, 0, 0) through the turn's change
    fixed = vx * panels.normal[i, 0] + vy * panels.normal[i, 1] + vz * panels.normal[i, 2]
    return fixed + nx - panels.normal[i, 0]
