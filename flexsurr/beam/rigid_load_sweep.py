"""Compiled loads of every kind on any chain: dead or following, forces and couples, also off its axis.

`load_sweeps` has those that need less.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.beam.rigid_sweep import BODY, RigidElements, add_forces_on_bodies, sweep_bodies
from flexsurr.beam.spatial_sweep import add_projected
from flexsurr.simulation.history import HistoriesKernel, history_factor
from flexsurr.simulation.rhs import FLOATING_POINT, Array, implements_rhs, rhs


class RigidLoaded(NamedTuple):
    """A model of any chain under k loads of fixed shapes, dead or in the elements' own axes."""

    model: Any  # kernel of the model without the loads
    modes: Array  # (r, 4 N) Φᵀ, blocks ψ, θ, φ, s
    elements: RigidElements
    on_middles: Array  # (k, N, 3) [N]
    on_tip: Array  # (k, 3) [N]
    on_masses: Array  # (k, N, 3) [N]
    couples: Array  # (k, N, 3) [N m]
    follows: NDArray[np.bool_]  # (k,)
    histories: HistoriesKernel


def rigid_load_work_size(elements: int) -> int:
    """Scratch of `rigid_loaded_rhs` beyond the model's."""
    return (BODY + 13) * elements + 3


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def add_turned(body, follows, factor, part, total):
    """Add `factor` times `part` (3,) to `total` (3,); if it follows it is in the axes of `body`."""
    a, b, c = factor * part[0], factor * part[1], factor * part[2]
    if follows:
        for k in range(3):
            total[k] += a * body[18 + k] + b * body[21 + k] + c * body[24 + k]
    else:
        total[0] += a
        total[1] += b
        total[2] += c


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def add_couples_on_bodies(bodies, couples, forces):
    """Add what moments on the elements, `couples` (3 N,), exert on the joints to `forces` (4 N,)."""
    n = couples.shape[0] // 3
    m0 = m1 = m2 = 0.0
    for i in range(n - 1, -1, -1):
        b = bodies[BODY * i : BODY * (i + 1)]
        m0, m1, m2 = m0 + couples[3 * i], m1 + couples[3 * i + 1], m2 + couples[3 * i + 2]
        for joint in range(3):
            axis = 3 * joint
            forces[joint * n + i] += b[axis] * m0 + b[axis + 1] * m1 + b[axis + 2] * m2


@implements_rhs(RigidLoaded, inline=False)
def rigid_loaded_rhs(kernel, t, x, dx, work):
    """The model's right-hand side and the loads' moments about the joints' axes."""
    rhs(kernel.model, t, x, dx, work)
    n = kernel.on_middles.shape[1]
    bodies, scratch = work[: BODY * n], work[BODY * n :]
    forces, on_middles, on_masses = scratch[: 4 * n], scratch[4 * n : 7 * n], scratch[7 * n : 10 * n]
    couples, on_tip = scratch[10 * n : 13 * n], scratch[13 * n : 13 * n + 3]
    known = False
    for load in range(kernel.on_tip.shape[0]):
        factor = history_factor(kernel.histories, load, t)
        if factor == 0.0:
            continue
        if not known:
            sweep_bodies(kernel.modes, kernel.elements, x, bodies, scratch)
            for i in range(13 * n + 3):
                scratch[i] = 0.0
            known = True
        follows = kernel.follows[load]
        for i in range(n):
            body, own = bodies[BODY * i : BODY * (i + 1)], 3 * i
            add_turned(body, follows, factor, kernel.on_middles[load, i], on_middles[own : own + 3])
            add_turned(body, follows, factor, kernel.on_masses[load, i], on_masses[own : own + 3])
            add_turned(body, follows, factor, kernel.couples[load, i], couples[own : own + 3])
        add_turned(bodies[BODY * (n - 1) : BODY * n], follows, factor, kernel.on_tip[load], on_tip)
    if not known:
        return
    add_forces_on_bodies(bodies, on_masses.reshape((n, 3)), on_middles.reshape((n, 3)), on_tip, forces)
    add_couples_on_bodies(bodies, couples, forces)
    add_projected(kernel.modes, forces, dx)
