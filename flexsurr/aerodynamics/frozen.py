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
from flexsurr.simulation.mapping import CompiledMapping, implements_mapping
from flexsurr.simulation.rhs import Array


class FrozenMatrices(NamedTuple):
    """`inverse` (K, N, N): circulations for unit wash; `induced` (K, 3, N, N): velocities at bound vortices."""

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
    return FrozenMatrices(np.stack(inverses), np.stack(velocities))


def frozen(
    airframe: Airframe, grid: MachGrid, boundary_condition: BoundaryCondition = "exact"
) -> CompiledMapping:
    """The lattice of `airframe` with matrices frozen on `grid`, from the 25 features to the 12 coefficients."""
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
    wash, gamma = count, count + n
    write_weights(grid, u[MACH], work)
    for k in range(y.size):
        y[k] = 0.0
    for i in range(n):
        work[wash + i] = -normal_wash(exact, panels, u, i)
    for node in range(count):
        weight = work[node]
        if weight == 0.0:
            continue
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += inverse[node, i, j] * work[wash + j]
            work[gamma + i] = total
        for i in range(n):
            vx, vy, vz = 0.0, 0.0, 0.0
            for j in range(n):
                circulation = work[gamma + j]
                vx += induced[node, 0, i, j] * circulation
                vy += induced[node, 1, i, j] * circulation
                vz += induced[node, 2, i, j] * circulation
            add_vortex_force(exact, panels, u, i, weight * work[gamma + i], vx, vy, vz, y)
    add_body(exact, panels, u, y)
