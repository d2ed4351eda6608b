"""Compiled loads: any compiled model in the beam's coordinates, plus Φᵀ Jᵀ F(t), in O(N)."""

from typing import Any, NamedTuple

from flexsurr.beam.planar_sweep import padded_length, planar_angles
from flexsurr.beam.spatial_sweep import AXES, add_dead_forces, sweep_axes
from flexsurr.simulation.history import HistoryKernel, history_factor
from flexsurr.simulation.rhs import Array, implements_rhs, rhs


class PlanarLoaded(NamedTuple):
    """A model of a chain in a plane under a dead load of fixed shape."""

    model: Any  # kernel of the model without the load
    slopes: Array  # (r, P) absolute angles for each η, padded with zeros
    arms: Array  # (2, P) moment arms of the load's shape [N m], likewise
    history: HistoryKernel


class SpatialLoaded(NamedTuple):
    """A model of any chain under dead forces of fixed shape."""

    model: Any  # kernel of the model without the load
    modes: Array  # (r, 4 N) Φᵀ, blocks ψ, θ, φ, s
    clamp: Array  # (3, 3) columns are the clamp's axes
    element_length: float  # [m]
    weightless: Array  # (3,) zeros: the load is on the elastic axis
    on_centres: Array  # (N, 3) [N]
    on_tip: Array  # (3,) [N]
    history: HistoryKernel


def planar_load_work_size(elements: int) -> int:
    """Scratch of `planar_loaded_rhs` beyond the model's."""
    return 2 * padded_length(elements)


def spatial_load_work_size(elements: int) -> int:
    """Scratch of `spatial_loaded_rhs` beyond the model's."""
    return (AXES + 10) * elements


@implements_rhs(PlanarLoaded, inline=False)
def planar_loaded_rhs(kernel, t, x, dx, work):
    """The model's right-hand side and the load's moments about the elements' roots."""
    rhs(kernel.model, t, x, dx, work)
    factor = history_factor(kernel.history, t)
    if factor == 0.0:
        return
    r, n = kernel.slopes.shape
    sine, cosine = work[:n], work[n : 2 * n]
    planar_angles(kernel.slopes, x, sine, cosine)
    along, normal = kernel.arms[0], kernel.arms[1]
    for k in range(r):
        slopes = kernel.slopes[k]
        force = 0.0
        for i in range(n):
            force += slopes[i] * (normal[i] * cosine[i] - along[i] * sine[i])
        dx[r + k] += factor * force


@implements_rhs(SpatialLoaded, inline=False)
def spatial_loaded_rhs(kernel, t, x, dx, work):
    """The model's right-hand side and the load's moments about the joints' axes."""
    rhs(kernel.model, t, x, dx, work)
    factor = history_factor(kernel.history, t)
    if factor == 0.0:
        return
    r = kernel.modes.shape[0]
    n = kernel.on_centres.shape[0]
    axes, scratch, forces = work[: AXES * n], work[AXES * n :], work[AXES * n : (AXES + 4) * n]
    sweep_axes(kernel.modes, kernel.clamp, kernel.element_length, x, axes, scratch)
    for i in range(4 * n):
        forces[i] = 0.0
    add_dead_forces(axes, 0.0, kernel.weightless, kernel.on_centres, kernel.on_tip, forces)
    for k in range(r):
        row = kernel.modes[k]
        force = 0.0
        for i in range(4 * n):
            force += row[i] * forces[i]
        dx[r + k] += factor * force
