"""Compiled inertial forces of a turning clamp, on any model of any chain: see `clamp_rotation`.

One sweep out with the model's own rates, which it has just written, and one back.
"""

import math
from typing import Any, NamedTuple

from numba import njit

from flexsurr.beam.rigid_load_sweep import add_couples_on_bodies
from flexsurr.beam.rigid_sweep import (
    BODY,
    RigidElements,
    add_forces_on_bodies,
    sweep_bodies,
    sweep_roots,
)
from flexsurr.beam.spatial_sweep import add_projected, joint_values
from flexsurr.simulation.history import HistoriesKernel, history_factor, history_integral, history_slope
from flexsurr.simulation.rhs import FLOATING_POINT, Array, implements_rhs, rhs


class ClampTurned(NamedTuple):
    """A model of any chain whose clamp turns; vectors in the clamp's frame before it is turned."""

    model: Any  # kernel of the model as if the clamp were at rest
    modes: Array  # (r, 4 N) Φᵀ, blocks ψ, θ, φ, s
    elements: RigidElements
    masses: Array  # (N,) [kg]
    tensors: Array  # (N, 3, 3) inertia about the centres of gravity [kg m²]
    unloaded: Array  # (N, 3) zeros: no force on the middles
    rate: Array  # (3,) angular velocity at a factor of 1 [rad/s]
    axis: Array  # (3,) unit vector along it
    arm: Array  # (3,) from the axis to the clamp [m]
    gravity: Array  # (3,) at the beginning [m/s²]
    history: HistoriesKernel  # one
    exact: bool
    tilts: bool  # whether gravity turns, seen from the clamp


def clamp_work_size(elements: int) -> int:
    """Scratch of `clamp_turned_rhs` beyond the model's."""
    return (BODY + 20) * elements


@njit(fastmath=FLOATING_POINT, error_model="numpy", forceinline=True, cache=True)
def crossed(a, b):
    """The cross product a × b of triples."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(fastmath=FLOATING_POINT, error_model="numpy", forceinline=True, cache=True)
def along_own_axes(body, v):
    """A vector's components along an element's axes, which `body` has."""
    return (
        v[0] * body[18] + v[1] * body[19] + v[2] * body[20],
        v[0] * body[21] + v[1] * body[22] + v[2] * body[23],
        v[0] * body[24] + v[1] * body[25] + v[2] * body[26],
    )


@njit(fastmath=FLOATING_POINT, error_model="numpy", forceinline=True, cache=True)
def momentum(tensor, w):
    """I w of a tensor (3, 3) and a triple."""
    return (
        tensor[0, 0] * w[0] + tensor[0, 1] * w[1] + tensor[0, 2] * w[2],
        tensor[1, 0] * w[0] + tensor[1, 1] * w[1] + tensor[1, 2] * w[2],
        tensor[2, 0] * w[0] + tensor[2, 1] * w[1] + tensor[2, 2] * w[2],
    )


@njit(fastmath=FLOATING_POINT, error_model="numpy", forceinline=True, cache=True)
def tilt(kernel, t):
    """Gravity as it is seen from the clamp at t [s], less what it was at first: Rodrigues' rotation back."""
    if not kernel.tilts:
        return 0.0, 0.0, 0.0
    axis, g = kernel.axis, kernel.gravity
    rate = kernel.rate[0] * axis[0] + kernel.rate[1] * axis[1] + kernel.rate[2] * axis[2]
    angle = rate * history_integral(kernel.history, 0, t)
    fall, sine = math.cos(angle) - 1.0, math.sin(angle)
    across = crossed((axis[0], axis[1], axis[2]), (g[0], g[1], g[2]))
    part = crossed(across, (axis[0], axis[1], axis[2]))
    return (
        fall * part[0] - sine * across[0],
        fall * part[1] - sine * across[1],
        fall * part[2] - sine * across[2],
    )


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def clamp_forces(kernel, t, bodies, rates, roots, on_masses, couples):
    """Write what the masses (3 N,) and the elements (3 N,), if their inertia is exact, feel.

    For joint rates (4 N,) with which the elements' roots move as `roots` (6 N,) says.
    """
    n = kernel.masses.shape[0]
    factor, growth = history_factor(kernel.history, 0, t), history_slope(kernel.history, 0, t)
    w = factor * kernel.rate[0], factor * kernel.rate[1], factor * kernel.rate[2]
    dw = growth * kernel.rate[0], growth * kernel.rate[1], growth * kernel.rate[2]
    g = tilt(kernel, t)
    x, y, z = kernel.arm[0], kernel.arm[1], kernel.arm[2]
    for i in range(n):
        b, root = bodies[BODY * i : BODY * (i + 1)], roots[6 * i : 6 * (i + 1)]
        psi, theta, phi, stretch = rates[i], rates[n + i], rates[2 * n + i], rates[3 * n + i]
        turns = (
            root[0] + psi * b[0] + theta * b[3] + phi * b[6],
            root[1] + psi * b[1] + theta * b[4] + phi * b[7],
            root[2] + psi * b[2] + theta * b[5] + phi * b[8],
        )
        v = crossed(turns, (b[15], b[16], b[17]))
        place = x + b[15], y + b[16], z + b[17]
        x, y, z = x + b[12], y + b[13], z + b[14]
        e, u = crossed(dw, place), crossed(w, place)
        c = crossed(
            w,
            (
                u[0] + 2.0 * (root[3] + stretch * b[9] + v[0]),
                u[1] + 2.0 * (root[4] + stretch * b[10] + v[1]),
                u[2] + 2.0 * (root[5] + stretch * b[11] + v[2]),
            ),
        )
        for k in range(3):
            on_masses[3 * i + k] = kernel.masses[i] * (g[k] - e[k] - c[k])
        if kernel.exact:
            tensor = kernel.tensors[i]
            spin, clamp, faster = along_own_axes(b, turns), along_own_axes(b, w), along_own_axes(b, dw)
            carried = crossed(spin, clamp)
            whole = clamp[0] + spin[0], clamp[1] + spin[1], clamp[2] + spin[2]
            change = faster[0] - carried[0], faster[1] - carried[1], faster[2] - carried[2]
            p, all_of_it, h = momentum(tensor, change), momentum(tensor, whole), momentum(tensor, spin)
            ours, alone = crossed(whole, all_of_it), crossed(spin, h)
            m = (
                alone[0] - ours[0] - p[0],
                alone[1] - ours[1] - p[1],
                alone[2] - ours[2] - p[2],
            )
            for k in range(3):
                couples[3 * i + k] = m[0] * b[18 + k] + m[1] * b[21 + k] + m[2] * b[24 + k]


@implements_rhs(ClampTurned, inline=False)
def clamp_turned_rhs(kernel, t, x, dx, work):
    """The model's right-hand side and the moments of inertial forces about the joints' axes."""
    rhs(kernel.model, t, x, dx, work)
    n = kernel.masses.shape[0]
    bodies, scratch = work[: BODY * n], work[BODY * n :]
    forces, rates, roots = scratch[: 4 * n], scratch[4 * n : 8 * n], scratch[8 * n : 14 * n]
    on_masses, couples = scratch[14 * n : 17 * n], scratch[17 * n : 20 * n]
    sweep_bodies(kernel.modes, kernel.elements, x, bodies, scratch)
    joint_values(kernel.modes, dx, rates)
    sweep_roots(bodies, kernel.elements.axial, rates, roots)
    clamp_forces(kernel, t, bodies, rates, roots, on_masses, couples)
    for i in range(4 * n):
        forces[i] = 0.0
    add_forces_on_bodies(bodies, on_masses.reshape((n, 3)), kernel.unloaded, kernel.unloaded[0], forces)
    if kernel.exact:
        add_couples_on_bodies(bodies, couples, forces)
    add_projected(kernel.modes, forces, dx)
