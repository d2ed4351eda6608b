"""From circulations to sums in body axes: Kutta–Joukowski's forces, the body's, parasite drag.

`flexsurr.aerodynamics.stability_axes` makes the twelve coefficients of them.
"""

from numba import njit

from flexsurr.aerodynamics.boundary import COMPILED, local_onset, onset
from flexsurr.aerodynamics.features import ALTITUDE, FIRST_MODAL, MACH, MODES
from flexsurr.aerodynamics.parasite_drag import parasite_drag
from flexsurr.aerodynamics.stability_axes import BODY_L, BODY_M, BODY_N, BODY_X, BODY_Y, BODY_Z


@njit(**COMPILED)
def add_vortex_force(exact, panels, u, i, gamma, vx, vy, vz, y):
    """Add to the sums `y` (12,) the force on bound vortex i of circulation `gamma` [m] (over V).

    (vx, vy, vz) is the velocity induced at its middle, over V. Induced drag comes out directly, since the
    force is square to the local velocity.
    """
    ox, oy, oz = local_onset(exact, u, panels.bound, panels.bound_shift, i)
    vx += ox
    vy += oy
    vz += oz
    lx, ly, lz = panels.vortex[i, 0], panels.vortex[i, 1], panels.vortex[i, 2]
    scale = 2.0 * gamma / panels.area
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
