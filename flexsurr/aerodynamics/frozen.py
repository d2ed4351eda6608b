"""The vortex lattice with its matrices frozen: inverted once on a grid of Mach numbers, then multiplied.

Coefficients (not matrices) are interpolated between Mach numbers: at a node they are the rebuilt lattice's.
"""

from typing import NamedTuple

import numpy as np

from flexsurr.aerodynamics.airframe import Airframe, Panels, panels_of
from flexsurr.aerodynamics.boundary import BoundaryCondition, normal_wash
from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES, MACH
from flexsurr.aerodynamics.forces import add_body, add_vortex_force
from flexsurr.aerodynamics.horseshoe import influence
from flexsurr.aerodynamics.mach_grid import MachGrid, write_weights
from flexsurr.aerodynamics.stability_axes import name_coefficients
from flexsurr.simulation.mapping import CompiledMapping, implements_mapping
from flexsurr.simulation.rhs import Array


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
    """The lattice of `airframe` with matrices frozen on `grid`, from 25 features to 12 coefficients."""
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
    write_weights(grid, u[MACH], work)
    for k in range(y.size):
        y[k] = 0.0
    for i in range(n):
        work[count + i] = -normal_wash(exact, panels, u, i)
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
            add_vortex_force(exact, panels, u, i, gamma, vx, vy, vz, y)
    add_body(exact, panels, u, y)
    name_coefficients(u, y)
