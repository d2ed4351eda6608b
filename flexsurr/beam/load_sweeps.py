"""Compiled loads: any compiled model in the beam's coordinates, plus Φᵀ Jᵀ F(t), in O(N) for each load.

Here are dead forces, and couples where a plane makes them constant; `rigid_load_sweep` has every other load.
"""

from typing import Any, NamedTuple

from flexsurr.beam.planar_sweep import padded_length, planar_angles
from flexsurr.beam.spatial_sweep import AXES, add_dead_forces, add_projected, sweep_axes
from flexsurr.simulation.history import HistoriesKernel, history_factor
from flexsurr.simulation.rhs import Array, implements_rhs, rhs


class PlanarLoaded(NamedTuple):
    """A model of a chain in a plane under k dead loads of fixed shapes."""

    model: Any  # kernel of the model without the loads
    slopes: Array  # (r, P) absolute angles for each η, padded with zeros
    arms: Array  # (k, 3, P) moment arms of each load's shape, and its couples [N m], likewise
    histories: HistoriesKernel


class SpatialLoaded(NamedTuple):
    """A model of any uniform, straight chain under k loads of dead forces of fixed shapes."""

    model: Any  # kernel of the model without the loads
    modes: Array  # (r, 4 N) Φᵀ, blocks ψ, θ, φ, s
    clamp: Array  # (3, 3) columns are the clamp's axes
    element_length: float  # [m]
    weightless: Array  # (3,) zeros: the loads are on the elastic axis
    on_centres: Array  # (k, N, 3) [N]
    on_tip: Array  # (k, 3) [N]
    histories: HistoriesKernel


def planar_load_work_size(elements: int) -> int:
    """Scratch of `planar_loaded_rhs` beyond the model's."""
    return 2 * padded_length(elements)


def spatial_load_work_size(elements: int) -> int:
    """Scratch of `spatial_loaded_rhs` beyond the model's."""
    return (AXES + 10) * elements + 3


@implements_rhs(PlanarLoaded, inline=False)
def planar_loaded_rhs(kernel, t, x, dx, work):
    """The model's right-hand side and the loads' moments about the elements' roots."""
    rhs(kernel.model, t, x, dx, work)
    r, n = kernel.slopes.shape
    sine, cosine = work[:n], work[n : 2 * n]
    known = False
    for load in range(kernel.arms.shape[0]):
        factor = history_factor(kernel.histories, load, t)
        if factor == 0.0:
            continue
        if not known:
            planar_angles(kernel.slopes, x, sine, cosine)
            known = True
        along, normal, couples = kernel.arms[load, 0], kernel.arms[load, 1], kernel.arms[load, 2]
        for k in range(r):
            slopes = kernel.slopes[k]
            force = 0.0
            for i in range(n):
                force += slopes[i] * (normal[i] * cosine[i] - along[i] * sine[i] + couples[i])
            dx[r + k] += factor * force


@implements_rhs(SpatialLoaded, inline=False)
def spatial_loaded_rhs(kernel, t, x, dx, work):
    """The model's right-hand side and the loads' moments about the joints' axes."""
    rhs(kernel.model, t, x, dx, work)
    n = kernel.on_centres.shape[1]
    axes, scratch = work[: AXES * n], work[AXES * n :]
    forces, on_centres, on_tip = scratch[: 4 * n], scratch[4 * n : 7 * n], scratch[7 * n : 7 * n + 3]
    known = False
    for load in range(kernel.on_tip.shape[0]):
        factor = history_factor(kernel.histories, load, t)
        if factor == 0.0:
            continue
        if not known:
            sweep_axes(kernel.modes, kernel.clamp, kernel.element_length, x, axes, scratch)
            for i in range(7 * n + 3):
                scratch[i] = 0.0
            known = True
        for k in range(3):
            on_tip[k] += factor * kernel.on_tip[load, k]
            for i in range(n):
                on_centres[3 * i + k] += factor * kernel.on_centres[load, i, k]
    if not known:
        return
    add_dead_forces(axes, 0.0, kernel.weightless, on_centres.reshape((n, 3)), on_tip, forces)
    add_projected(kernel.modes, forces, dx)
