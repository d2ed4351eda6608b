"""Compiled equations of a chain with any joints: a tangent sweep outwards, a momentum sweep back.

All four joints are swept at every element; one that is not enabled has zero rows in `modes`, which
keeps the sweeps free of cases. The gyroscopic term is summed by parts as in `vectorised`: O(N) for the
joints' forces, O(N r) to project them.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.beam.trigonometry import sine_cosine
from flexsurr.simulation.linear_solvers import solve_positive_definite
from flexsurr.simulation.rhs import FLOATING_POINT, Array, implements_rhs

# What `sweep_axes` keeps of each element: the axis of ψ (the element before's z), y after ψ, the element's
# x and y. Twelve numbers, and two lengths: from the root to the next node and to the centre.
AXES = 14


class SpatialChain(NamedTuple):
    """Any coordinates of a chain with any joints: states (η_1…η_r, p_1…p_r)."""

    modes: Array  # (r, 4 N) Φᵀ, blocks ψ, θ, φ, s
    first: NDArray[np.int64]  # (r,) first element that each coordinate moves
    clamp: Array  # (3, 3) columns are the clamp's axes
    element_length: float  # l [m]
    offset: float  # of the masses along the element's y [m]
    mass: float  # of each element [kg]
    weight: Array  # (3,) of each element [N]
    unloaded: Array  # (N, 3) zeros: no force on the centres but the weight
    rotary_inertia: Array  # (r, r)
    stiffness: Array  # (r, r)
    damping: Array  # (r, r)
    gyroscopic: bool
    heavy: bool


def spatial_work_size(elements: int, coordinates: int) -> int:
    """Scratch of `spatial_chain_rhs`."""
    return (AXES + 23 + 3 * coordinates) * elements + coordinates**2


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def joint_values(modes, x, joints):
    """Φ η (4 N,) for modes (r, 4 N) and η = x[:r]; likewise the joint rates for η̇."""
    r, m = modes.shape
    for i in range(m):
        joints[i] = 0.0
    for k in range(r):
        row, value = modes[k], x[k]
        for i in range(m):
            joints[i] += row[i] * value


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def add_projected(modes, forces, dx):
    """Add Φᵀ Q to the rates of the momenta, dx[r:], for modes (r, 4 N) and forces Q (4 N,) on the joints."""
    r, m = modes.shape
    for k in range(r):
        row = modes[k]
        force = 0.0
        for i in range(m):
            force += row[i] * forces[i]
        dx[r + k] += force


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def sweep_axes(modes, clamp, element_length, x, axes, work):
    """Write the axes (AXES N,) of the chain at η = x[:r]; `work` is scratch of 10 N."""
    n = modes.shape[1] // 4
    joints, sine, cosine = work[: 4 * n], work[4 * n : 7 * n], work[7 * n : 10 * n]
    joint_values(modes, x, joints)
    for i in range(3 * n):
        sine[i], cosine[i] = sine_cosine(joints[i])
    x0, x1, x2 = clamp[0, 0], clamp[1, 0], clamp[2, 0]
    y0, y1, y2 = clamp[0, 1], clamp[1, 1], clamp[2, 1]
    z0, z1, z2 = clamp[0, 2], clamp[1, 2], clamp[2, 2]
    for i in range(n):
        kept = axes[AXES * i : AXES * (i + 1)]
        kept[0], kept[1], kept[2] = z0, z1, z2
        c, s = cosine[i], sine[i]
        x0, y0 = c * x0 + s * y0, c * y0 - s * x0
        x1, y1 = c * x1 + s * y1, c * y1 - s * x1
        x2, y2 = c * x2 + s * y2, c * y2 - s * x2
        kept[3], kept[4], kept[5] = y0, y1, y2
        c, s = cosine[n + i], sine[n + i]
        x0, z0 = c * x0 + s * z0, c * z0 - s * x0
        x1, z1 = c * x1 + s * z1, c * z1 - s * x1
        x2, z2 = c * x2 + s * z2, c * z2 - s * x2
        kept[6], kept[7], kept[8] = x0, x1, x2
        c, s = cosine[2 * n + i], sine[2 * n + i]
        y0, z0 = c * y0 + s * z0, c * z0 - s * y0
        y1, z1 = c * y1 + s * z1, c * z1 - s * y1
        y2, z2 = c * y2 + s * z2, c * z2 - s * y2
        kept[9], kept[10], kept[11] = y0, y1, y2
        kept[12] = element_length + joints[3 * n + i]
        kept[13] = 0.5 * element_length + joints[3 * n + i]


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def sweep_velocities(axes, offset, first, rates, roots, masses):
    """Velocities of the masses (3 N,) for joint rates (4 N,) that are zero before element `first`.

    With the rates of a mode it is a column of the Jacobian. `roots` (6 N,) takes, if it is long enough,
    the angular velocity and the velocity with which each element's root moves.
    """
    n = masses.shape[0] // 3
    keep = roots.shape[0] > 0
    w0 = w1 = w2 = v0 = v1 = v2 = 0.0
    for i in range(3 * first):
        masses[i] = 0.0
    for i in range(first, n):
        a = axes[AXES * i : AXES * (i + 1)]
        if keep:
            kept = roots[6 * i : 6 * (i + 1)]
            kept[0], kept[1], kept[2], kept[3], kept[4], kept[5] = w0, w1, w2, v0, v1, v2
        psi, theta, phi, stretch = rates[i], rates[n + i], rates[2 * n + i], rates[3 * n + i]
        w0 += psi * a[0] - theta * a[3] + phi * a[6]
        w1 += psi * a[1] - theta * a[4] + phi * a[7]
        w2 += psi * a[2] - theta * a[5] + phi * a[8]
        u0, u1, u2 = w1 * a[8] - w2 * a[7], w2 * a[6] - w0 * a[8], w0 * a[7] - w1 * a[6]
        s0, s1, s2 = stretch * a[6], stretch * a[7], stretch * a[8]
        out = masses[3 * i : 3 * (i + 1)]
        out[0] = v0 + s0 + a[13] * u0 + offset * (w1 * a[11] - w2 * a[10])
        out[1] = v1 + s1 + a[13] * u1 + offset * (w2 * a[9] - w0 * a[11])
        out[2] = v2 + s2 + a[13] * u2 + offset * (w0 * a[10] - w1 * a[9])
        v0 += s0 + a[12] * u0
        v1 += s1 + a[12] * u1
        v2 += s2 + a[12] * u2


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def add_dead_forces(axes, offset, weight, on_centres, on_tip, forces):
    """Add dead forces to those on the joints, `forces` (4 N,).

    They are a weight (3,) on each mass, and forces on the elements' centres (N, 3) and on the tip (3,).
    """
    n = on_centres.shape[0]
    f0, f1, f2 = on_tip[0], on_tip[1], on_tip[2]
    m0 = m1 = m2 = 0.0
    for i in range(n - 1, -1, -1):
        a = axes[AXES * i : AXES * (i + 1)]
        g0, g1, g2 = on_centres[i, 0] + weight[0], on_centres[i, 1] + weight[1], on_centres[i, 2] + weight[2]
        h0, h1, h2 = a[12] * f0 + a[13] * g0, a[12] * f1 + a[13] * g1, a[12] * f2 + a[13] * g2
        m0 += a[7] * h2 - a[8] * h1 + offset * (a[10] * weight[2] - a[11] * weight[1])
        m1 += a[8] * h0 - a[6] * h2 + offset * (a[11] * weight[0] - a[9] * weight[2])
        m2 += a[6] * h1 - a[7] * h0 + offset * (a[9] * weight[1] - a[10] * weight[0])
        f0, f1, f2 = f0 + g0, f1 + g1, f2 + g2
        forces[i] += a[0] * m0 + a[1] * m1 + a[2] * m2
        forces[n + i] -= a[3] * m0 + a[4] * m1 + a[5] * m2
        forces[2 * n + i] += a[6] * m0 + a[7] * m1 + a[8] * m2
        forces[3 * n + i] += a[6] * f0 + a[7] * f1 + a[8] * f2


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def add_gyroscopic_forces(axes, offset, mass, rates, roots, masses, forces):
    """Add ½ ∂/∂q (q̇ᵀ M q̇) to `forces` (4 N,), from what `sweep_velocities` found for the rates (4 N,)."""
    n = masses.shape[0] // 3
    p0 = p1 = p2 = l0 = l1 = l2 = 0.0
    for i in range(n - 1, -1, -1):
        a, v, root = axes[AXES * i : AXES * (i + 1)], masses[3 * i : 3 * (i + 1)], roots[6 * i : 6 * (i + 1)]
        b0, b1, b2 = mass * v[0], mass * v[1], mass * v[2]
        h0, h1, h2 = a[12] * p0 + a[13] * b0, a[12] * p1 + a[13] * b1, a[12] * p2 + a[13] * b2
        l0 += a[7] * h2 - a[8] * h1 + offset * (a[10] * b2 - a[11] * b1)
        l1 += a[8] * h0 - a[6] * h2 + offset * (a[11] * b0 - a[9] * b2)
        l2 += a[6] * h1 - a[7] * h0 + offset * (a[9] * b1 - a[10] * b0)
        p0, p1, p2 = p0 + b0, p1 + b1, p2 + b2
        c0, c1, c2 = root[4] * p2 - root[5] * p1, root[5] * p0 - root[3] * p2, root[3] * p1 - root[4] * p0
        w0, w1, w2 = root[0], root[1], root[2]
        k0, k1, k2 = l1 * w2 - l2 * w1 - c0, l2 * w0 - l0 * w2 - c1, l0 * w1 - l1 * w0 - c2
        forces[i] += a[0] * k0 + a[1] * k1 + a[2] * k2
        psi, theta = rates[i], rates[n + i]
        w0, w1, w2 = w0 + psi * a[0], w1 + psi * a[1], w2 + psi * a[2]
        k0, k1, k2 = l1 * w2 - l2 * w1 - c0, l2 * w0 - l0 * w2 - c1, l0 * w1 - l1 * w0 - c2
        forces[n + i] -= a[3] * k0 + a[4] * k1 + a[5] * k2
        w0, w1, w2 = w0 - theta * a[3], w1 - theta * a[4], w2 - theta * a[5]
        k0, k1, k2 = l1 * w2 - l2 * w1 - c0, l2 * w0 - l0 * w2 - c1, l0 * w1 - l1 * w0 - c2
        forces[2 * n + i] += a[6] * k0 + a[7] * k1 + a[8] * k2
        k0, k1, k2 = p1 * w2 - p2 * w1, p2 * w0 - p0 * w2, p0 * w1 - p1 * w0
        forces[3 * n + i] += a[6] * k0 + a[7] * k1 + a[8] * k2


@implements_rhs(SpatialChain, inline=False)
def spatial_chain_rhs(kernel, t, x, dx, work):
    """Eqs. 6, 7 and 10."""
    r = kernel.modes.shape[0]
    n = kernel.unloaded.shape[0]
    axes, jacobian = work[: AXES * n], work[AXES * n : (AXES + 3 * r) * n]
    scratch = work[(AXES + 3 * r) * n :]
    rates, masses, roots = scratch[: 4 * n], scratch[4 * n : 7 * n], scratch[7 * n : 13 * n]
    forces, mass = scratch[13 * n : 17 * n], scratch[17 * n + 6 * n :]
    sweep_axes(kernel.modes, kernel.clamp, kernel.element_length, x, axes, scratch)
    for k in range(r):
        column = jacobian[3 * n * k : 3 * n * (k + 1)]
        sweep_velocities(axes, kernel.offset, kernel.first[k], kernel.modes[k], scratch[:0], column)
        for j in range(k + 1):
            total = 0.0
            other = jacobian[3 * n * j : 3 * n * (j + 1)]
            for i in range(3 * max(kernel.first[k], kernel.first[j]), 3 * n):
                total += column[i] * other[i]
            mass[r * k + j] = kernel.mass * total + kernel.rotary_inertia[k, j]
        dx[k] = x[r + k]
    solve_positive_definite(mass, dx, r)

    for k in range(r):
        force = 0.0
        for j in range(r):
            force -= kernel.stiffness[k, j] * x[j] + kernel.damping[k, j] * dx[j]
        dx[r + k] = force
    if not (kernel.gyroscopic or kernel.heavy):
        return
    for i in range(4 * n):
        forces[i] = 0.0
    if kernel.heavy:
        add_dead_forces(axes, kernel.offset, kernel.weight, kernel.unloaded, kernel.unloaded[0], forces)
    if kernel.gyroscopic:
        joint_values(kernel.modes, dx, rates)
        # An untyped 0 would compile the sweep once more, for that number alone.
        sweep_velocities(axes, kernel.offset, np.int64(0), rates, roots, masses)
        add_gyroscopic_forces(axes, kernel.offset, kernel.mass, rates, roots, masses, forces)
    add_projected(kernel.modes, forces, dx)
