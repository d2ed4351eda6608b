"""The vortex lattice rebuilt at every call: what the study's reference simulation pays for."""

import math
from typing import NamedTuple

import numpy as np

from flexsurr.aerodynamics.airframe import Airframe, Panels, panels_of
from flexsurr.aerodynamics.boundary import BoundaryCondition, normal_wash
from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES, MACH
from flexsurr.aerodynamics.forces import add_body, add_vortex_force
from flexsurr.aerodynamics.horseshoe import induced
from flexsurr.aerodynamics.stability_axes import name_coefficients
from flexsurr.simulation.mapping import CompiledMapping, implements_mapping


class Rebuilt(NamedTuple):
    """Influence matrix, solution and induced velocities anew at every call, at the Mach number given."""

    panels: Panels
    exact: bool


def rebuilt(airframe: Airframe, boundary_condition: BoundaryCondition = "exact") -> CompiledMapping:
    """The vortex lattice of `airframe`, from the 25 features to the 12 coefficients."""
    kernel = Rebuilt(panels_of(airframe), boundary_condition == "exact")
    return CompiledMapping(kernel, 0, FEATURES, COEFFICIENTS)


@implements_mapping(Rebuilt, allocates=True)
def _rebuilt(kernel, u, y, work):
    panels, exact = kernel
    ends = panels.ends
    n = ends.shape[1]
    stretch = 1.0 / math.sqrt(1.0 - u[MACH] * u[MACH])
    matrix = np.empty((n, n))
    wash = np.empty(n)
    total = stretch
    for i in range(n):
        x, y_, z = panels.control[i, 0], panels.control[i, 1], panels.control[i, 2]
        nx, ny, nz = panels.normal[i, 0], panels.normal[i, 1], panels.normal[i, 2]
        for j in range(n):
            vx, vy, vz = induced(ends, j, stretch, x, y_, z)
            matrix[i, j] = vx * nx + vy * ny + vz * nz
        wash[i] = -normal_wash(exact, panels, u, i)
        total += wash[i]
    if not abs(total) < np.inf:
        # beyond Mach 1, or after a flight has left the numbers: LAPACK would raise where others go on
        for k in range(y.size):
            y[k] = np.nan
        return
    gamma = np.linalg.solve(matrix, wash)
    for k in range(y.size):
        y[k] = 0.0
    for i in range(n):
        x, y_, z = panels.bound[i, 0], panels.bound[i, 1], panels.bound[i, 2]
        vx, vy, vz = 0.0, 0.0, 0.0
        for j in range(n):
            ux, uy, uz = induced(ends, j, stretch, x, y_, z)
            vx += gamma[j] * ux
            vy += gamma[j] * uy
            vz += gamma[j] * uz
        add_vortex_force(exact, panels, u, i, gamma[i], vx, vy, vz, y)
    add_body(exact, panels, u, y)
    name_coefficients(u, y)
