"""The vortex lattice, rebuilt at every call, or with its matrices frozen on a grid of Mach numbers.

The rebuilt one is what the study's reference simulation pays for. The frozen one inverts its matrices once on
the grid, then multiplies; coefficients (not matrices) are interpolated between Mach numbers, so at a node
they are the rebuilt lattice's.
"""

import math
from typing import NamedTuple

import numpy as np

from flexsurr.aerodynamics.airframe import Airframe, Panels, panels_of
from flexsurr.aerodynamics.boundary import BoundaryCondition, normal_wash, onset
from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES, MACH
from flexsurr.aerodynamics.forces import add_body, add_vortex_force, name_coefficients
from flexsurr.aerodynamics.halves import frozen_in_halves, halves_of
from flexsurr.aerodynamics.horseshoe import induced, influence
from flexsurr.aerodynamics.mach_grid import MachGrid, write_weights
from flexsurr.simulation.mapping import CompiledMapping, implements_mapping
from flexsurr.simulation.rhs import Array


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
    far = onset(exact, u)
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
        wash[i] = -normal_wash(exact, far, panels, u, i)
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
        g = gamma[i]
        add_vortex_force(far, panels, u, i, g, g * vx, g * vy, g * vz, y)
    add_body(exact, panels, u, y)
    name_coefficients(u, y)


class FrozenMatrices(NamedTuple):
    """`inverse` (K, N, N): circulations for unit wash; `induced` (K, 3, N, N): velocities they induce."""

    inverse: Array
    induced: Array


class Frozen(NamedTuple):
    """Matrices at the K nodes of a grid of Mach numbers."""

    panels: Panels
    exact: bool
    grid: MachGrid
    matrices: FrozenMatrices


def frozen_matrices(panels: Panels, grid: MachGrid) -> FrozenMatrices:
    """The matrices of `panels` at the nodes of `grid`."""
    inverses, velocities = [], []
    for node in grid.nodes:
        at_control = influence(panels.ends, 1.0 / node, panels.control)
        inverses.append(np.linalg.inv(np.einsum("dij,id->ij", at_control, panels.normal)))
        velocities.append(influence(panels.ends, 1.0 / node, panels.bound))
    return FrozenMatrices(np.ascontiguousarray(np.stack(inverses)), np.stack(velocities))


def frozen(
    airframe: Airframe, grid: MachGrid, boundary_condition: BoundaryCondition = "exact"
) -> CompiledMapping:
    """The lattice of `airframe` with matrices frozen on `grid`, from 25 features to 12 coefficients.

    In halves where its panels are their own mirror image, else whole.
    """
    halves = halves_of(airframe.lattice)
    if halves is None:
        return frozen_whole(airframe, grid, boundary_condition)
    return frozen_in_halves(panels_of(airframe), halves, grid, boundary_condition == "exact")


def frozen_whole(
    airframe: Airframe, grid: MachGrid, boundary_condition: BoundaryCondition = "exact"
) -> CompiledMapping:
    """The same of any lattice, symmetric or not."""
    panels = panels_of(airframe)
    kernel = Frozen(panels, boundary_condition == "exact", grid, frozen_matrices(panels, grid))
    work_size = len(grid.nodes) + 2 * len(airframe.lattice)
    return CompiledMapping(kernel, work_size, FEATURES, COEFFICIENTS)


@implements_mapping(Frozen)
def _frozen(kernel, u, y, work):
    panels, exact, grid, matrices = kernel
    inverse, induced = matrices
    n = panels.normal.shape[0]
    count = grid.nodes.size
    # work: weights of the nodes, wash, circulations
    # unsigned: numba lets a signed index be negative, and a loop over such does not vectorise
    columns = np.uint64(n)
    wash, circulations = np.uint64(count), np.uint64(count + n)
    far = onset(exact, u)
    write_weights(grid, u[MACH], work)
    for k in range(y.size):
        y[k] = 0.0
    for i in range(n):
        work[count + i] = -normal_wash(exact, far, panels, u, i)
    for node in range(count):
        weight = work[node]
        if weight == 0.0:
            continue
        for i in range(n):
            total = 0.0
            for j in range(columns):
                total += inverse[node, i, j] * work[wash + j]
            work[count + n + i] = total
        for i in range(n):
            vx, vy, vz = 0.0, 0.0, 0.0
            for j in range(columns):
                gamma = work[circulations + j]
                vx += induced[node, 0, i, j] * gamma
                vy += induced[node, 1, i, j] * gamma
                vz += induced[node, 2, i, j] * gamma
            gamma = weight * work[count + n + i]
            add_vortex_force(far, panels, u, i, gamma, gamma * vx, gamma * vy, gamma * vz, y)
    add_body(exact, panels, u, y)
    name_coefficients(u, y)
