"""Compiled loads on any chain, as `load_sweeps` has them on those that are uniform and straight."""

from typing import Any, NamedTuple

from flexsurr.beam.rigid_sweep import BODY, RigidElements, add_forces_on_bodies, sweep_bodies
from flexsurr.simulation.history import HistoryKernel, history_factor
from flexsurr.simulation.rhs import Array, implements_rhs, rhs


class RigidLoaded(NamedTuple):
    """A model of any chain under dead forces of fixed shape."""

    model: Any  # kernel of the model without the load
    modes: Array  # (r, 4 N) Φᵀ, blocks ψ, θ, φ, s
    elements: RigidElements
    weightless: Array  # (N, 3) zeros: the load is on the elastic axis
    on_centres: Array  # (N, 3) [N]
    on_tip: Array  # (3,) [N]
    history: HistoryKernel


def rigid_load_work_size(elements: int) -> int:
    """Scratch of `rigid_loaded_rhs` beyond the model's."""
    return (BODY + 10) * elements


@implements_rhs(RigidLoaded, inline=False)
def rigid_loaded_rhs(kernel, t, x, dx, work):
    """The model's right-hand side and the load's moments about the joints' axes."""
    rhs(kernel.model, t, x, dx, work)
    factor = history_factor(kernel.history, t)
    if factor == 0.0:
        return
    r = kernel.modes.shape[0]
    n = kernel.on_centres.shape[0]
    bodies, scratch, forces = work[: BODY * n], work[BODY * n :], work[BODY * n : (BODY + 4) * n]
    sweep_bodies(kernel.modes, kernel.elements, x, bodies, scratch)
    for i in range(4 * n):
        forces[i] = 0.0
    add_forces_on_bodies(bodies, kernel.weightless, kernel.on_centres, kernel.on_tip, forces)
    for k in range(r):
        row = kernel.modes[k]
        force = 0.0
        for i in range(4 * n):
            force += row[i] * forces[i]
        dx[r + k] += factor * force
