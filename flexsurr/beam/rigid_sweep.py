"""Compiled equations of any chain: elements of any mass, axis and inertia, joints in sequence or by a vector.

The same two sweeps as in `spatial_sweep`, whose chains are uniform and straight and need less of everything.
What an element is follows from its body: the axes of its joints, its frame, and where in it things are.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.beam.rotation_vector import stumpff_4_5
from flexsurr.beam.spatial_sweep import add_projected, joint_values
from flexsurr.beam.trigonometry import sine_cosine
from flexsurr.simulation.linear_solvers import solve_positive_definite
from flexsurr.simulation.rhs import FLOATING_POINT, Array, implements_rhs

# What `sweep_bodies` keeps of each element, vectors in the clamp's frame before it is turned: angular
# velocities for unit rates of ψ, θ and φ (0, 3, 6); the stretch's direction (9); from the root to the next
# node (12) and to the centre of gravity (15); the element's x, y and z (18, 21, 24); from the root to its
# middle (27). Of a rotation vector besides: itself (30), c₂, c₃ and their slopes over |u|² (33 to 36).
BODY = 37


class RigidElements(NamedTuple):
    """The chain, whatever moves it; vectors in each element's own frame."""

    clamp: Array  # (3, 3) columns are the clamp's axes
    turns: Array  # (N, 3, 3) from the frame before, where the axis is bent
    spans: Array  # (N, 3) to the next node [m]
    stretches: Array  # (N, 3) unit vectors
    middles: Array  # (N, 3) [m]
    arms: Array  # (N, 3) to the centre of gravity [m]
    bent: bool  # otherwise all lie along the element's x
    by_vector: bool
    axial: bool  # whether the axial joints move


class RigidChain(NamedTuple):
    """Any coordinates of any chain: states (η_1…η_r, p_1…p_r)."""

    modes: Array  # (r, 4 N) Φᵀ, blocks ψ, θ, φ, s
    first: NDArray[np.int64]  # (r,) first element that each coordinate moves
    elements: RigidElements
    masses: Array  # (N,) [kg]
    root_masses: Array  # (N,) √m
    root_tensors: Array  # (N, 3, 3) A with AᵀA = I, the inertia about the centres of gravity [kg m²]
    weights: Array  # (N, 3) [N]
    unloaded: Array  # (N, 3) zeros: no force on the middles
    rotary_inertia: Array  # (r, r) constant
    stiffness: Array  # (r, r)
    damping: Array  # (r, r)
    exact: bool
    gyroscopic: bool
    heavy: bool


def rigid_work_size(elements: int, coordinates: int) -> int:
    """Scratch of `rigid_chain_rhs`."""
    return (BODY + 29 + 6 * coordinates) * elements + coordinates**2


@njit(fastmath=FLOATING_POINT, error_model="numpy", forceinline=True, cache=True)
def put(out, start, frame, vector):
    """Write the vector (3,) in an element's frame to `out` at `start`, in the clamp's; x, y, z at `frame`."""
    a, b, c = vector[0], vector[1], vector[2]
    for k in range(3):
        out[start + k] = a * out[frame + k] + b * out[frame + 3 + k] + c * out[frame + 6 + k]


@njit(fastmath=FLOATING_POINT, error_model="numpy", forceinline=True, cache=True)
def turned_row(x, y, z, u0, u1, u2, c1, c2, c3):
    """A row v of a frame before turned by u, v R, and that of the axes of φ, θ and ψ, v R T.

    R T is Tᵀ (see `rotation_vector`): both are sums of v, v [u] = v × u, and that times [u] again.
    """
    o0, o1, o2 = y * u2 - z * u1, z * u0 - x * u2, x * u1 - y * u0
    t0, t1, t2 = o1 * u2 - o2 * u1, o2 * u0 - o0 * u2, o0 * u1 - o1 * u0
    return (
        x + c1 * o0 + c2 * t0,
        y + c1 * o1 + c2 * t1,
        z + c1 * o2 + c2 * t2,
        x + c2 * o0 + c3 * t0,
        -(y + c2 * o1 + c3 * t1),
        z + c2 * o2 + c3 * t2,
    )


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def sweep_bodies(modes, elements, x, bodies, work):
    """Write the bodies (BODY N,) of the chain at η = x[:r]; `work` is scratch of 10 N."""
    n = modes.shape[1] // 4
    joints, one, other = work[: 4 * n], work[4 * n : 7 * n], work[7 * n : 10 * n]
    joint_values(modes, x, joints)
    if elements.by_vector:
        for i in range(n):
            psi, theta, phi = joints[i], joints[n + i], joints[2 * n + i]
            one[i], other[i] = stumpff_4_5(psi * psi + theta * theta + phi * phi)
    else:
        for i in range(3 * n):
            one[i], other[i] = sine_cosine(joints[i])
    clamp = elements.clamp
    x0, x1, x2 = clamp[0, 0], clamp[1, 0], clamp[2, 0]
    y0, y1, y2 = clamp[0, 1], clamp[1, 1], clamp[2, 1]
    z0, z1, z2 = clamp[0, 2], clamp[1, 2], clamp[2, 2]
    for i in range(n):
        b = bodies[BODY * i : BODY * (i + 1)]
        if elements.bent:
            t = elements.turns[i]
            x0, y0, z0 = (
                x0 * t[0, 0] + y0 * t[1, 0] + z0 * t[2, 0],
                x0 * t[0, 1] + y0 * t[1, 1] + z0 * t[2, 1],
                x0 * t[0, 2] + y0 * t[1, 2] + z0 * t[2, 2],
            )
            x1, y1, z1 = (
                x1 * t[0, 0] + y1 * t[1, 0] + z1 * t[2, 0],
                x1 * t[0, 1] + y1 * t[1, 1] + z1 * t[2, 1],
                x1 * t[0, 2] + y1 * t[1, 2] + z1 * t[2, 2],
            )
            x2, y2, z2 = (
                x2 * t[0, 0] + y2 * t[1, 0] + z2 * t[2, 0],
                x2 * t[0, 1] + y2 * t[1, 1] + z2 * t[2, 1],
                x2 * t[0, 2] + y2 * t[1, 2] + z2 * t[2, 2],
            )
        if elements.by_vector:
            u0, u1, u2 = joints[2 * n + i], -joints[n + i], joints[i]
            s = u0 * u0 + u1 * u1 + u2 * u2
            c4, c5 = one[i], other[i]
            c2, c3 = 0.5 - s * c4, 1.0 / 6.0 - s * c5
            c1 = 1.0 - s * c3
            x0, y0, z0, b[6], b[3], b[0] = turned_row(x0, y0, z0, u0, u1, u2, c1, c2, c3)
            x1, y1, z1, b[7], b[4], b[1] = turned_row(x1, y1, z1, u0, u1, u2, c1, c2, c3)
            x2, y2, z2, b[8], b[5], b[2] = turned_row(x2, y2, z2, u0, u1, u2, c1, c2, c3)
            b[30], b[31], b[32] = u0, u1, u2
            b[33], b[34], b[35], b[36] = c2, c3, c4 - 0.5 * c3, 1.5 * c5 - 0.5 * c4
        else:
            b[0], b[1], b[2] = z0, z1, z2
            c, s = other[i], one[i]
            x0, y0 = c * x0 + s * y0, c * y0 - s * x0
            x1, y1 = c * x1 + s * y1, c * y1 - s * x1
            x2, y2 = c * x2 + s * y2, c * y2 - s * x2
            b[3], b[4], b[5] = -y0, -y1, -y2
            c, s = other[n + i], one[n + i]
            x0, z0 = c * x0 + s * z0, c * z0 - s * x0
            x1, z1 = c * x1 + s * z1, c * z1 - s * x1
            x2, z2 = c * x2 + s * z2, c * z2 - s * x2
            b[6], b[7], b[8] = x0, x1, x2
            c, s = other[2 * n + i], one[2 * n + i]
            y0, z0 = c * y0 + s * z0, c * z0 - s * y0
            y1, z1 = c * y1 + s * z1, c * z1 - s * y1
            y2, z2 = c * y2 + s * z2, c * z2 - s * y2
        b[18], b[19], b[20] = x0, x1, x2
        b[21], b[22], b[23] = y0, y1, y2
        b[24], b[25], b[26] = z0, z1, z2
        put(b, 15, 18, elements.arms[i])
        if elements.bent:
            put(b, 9, 18, elements.stretches[i])
            put(b, 12, 18, elements.spans[i])
            put(b, 27, 18, elements.middles[i])
        else:
            length = elements.spans[i, 0]
            for k in range(3):
                along = b[18 + k]
                b[9 + k], b[12 + k], b[27 + k] = along, length * along, 0.5 * length * along
        if elements.axial:
            stretch = joints[3 * n + i]
            for k in range(3):
                moved = stretch * b[9 + k]
                b[12 + k] += moved
                b[15 + k] += moved
                b[27 + k] += moved


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def sweep_column(kernel, bodies, inertia, first, rates, column):
    """A column of the Jacobian for joint rates (4 N,) that are zero before `first`, weighted.

    Velocities of the centres of gravity (3 N,) times √m, and where the inertia is exact the spins of the
    elements (3 N,) times what `turn_inertia` has found.
    """
    n = kernel.masses.shape[0]
    exact, axial = kernel.exact, kernel.elements.axial
    w0 = w1 = w2 = v0 = v1 = v2 = 0.0
    for i in range(3 * first):
        column[i] = 0.0
    if exact:
        for i in range(3 * n, 3 * (n + first)):
            column[i] = 0.0
    for i in range(first, n):
        b = bodies[BODY * i : BODY * (i + 1)]
        psi, theta, phi = rates[i], rates[n + i], rates[2 * n + i]
        w0 += psi * b[0] + theta * b[3] + phi * b[6]
        w1 += psi * b[1] + theta * b[4] + phi * b[7]
        w2 += psi * b[2] + theta * b[5] + phi * b[8]
        if axial:
            stretch = rates[3 * n + i]
            v0, v1, v2 = v0 + stretch * b[9], v1 + stretch * b[10], v2 + stretch * b[11]
        root, out = kernel.root_masses[i], column[3 * i : 3 * (i + 1)]
        out[0] = root * (v0 + w1 * b[17] - w2 * b[16])
        out[1] = root * (v1 + w2 * b[15] - w0 * b[17])
        out[2] = root * (v2 + w0 * b[16] - w1 * b[15])
        if exact:
            a, spin = inertia[9 * i : 9 * (i + 1)], column[3 * (n + i) : 3 * (n + i + 1)]
            spin[0] = a[0] * w0 + a[1] * w1 + a[2] * w2
            spin[1] = a[3] * w0 + a[4] * w1 + a[5] * w2
            spin[2] = a[6] * w0 + a[7] * w1 + a[8] * w2
        v0, v1, v2 = (
            v0 + w1 * b[14] - w2 * b[13],
            v1 + w2 * b[12] - w0 * b[14],
            v2 + w0 * b[13] - w1 * b[12],
        )


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def sweep_roots(bodies, axial, rates, roots):
    """With which angular velocity and velocity each element's root moves (6 N,), for joint rates (4 N,)."""
    n = roots.shape[0] // 6
    w0 = w1 = w2 = v0 = v1 = v2 = 0.0
    for i in range(n):
        b, kept = bodies[BODY * i : BODY * (i + 1)], roots[6 * i : 6 * (i + 1)]
        kept[0], kept[1], kept[2], kept[3], kept[4], kept[5] = w0, w1, w2, v0, v1, v2
        psi, theta, phi = rates[i], rates[n + i], rates[2 * n + i]
        w0 += psi * b[0] + theta * b[3] + phi * b[6]
        w1 += psi * b[1] + theta * b[4] + phi * b[7]
        w2 += psi * b[2] + theta * b[5] + phi * b[8]
        if axial:
            stretch = rates[3 * n + i]
            v0, v1, v2 = v0 + stretch * b[9], v1 + stretch * b[10], v2 + stretch * b[11]
        v0, v1, v2 = (
            v0 + w1 * b[14] - w2 * b[13],
            v1 + w2 * b[12] - w0 * b[14],
            v2 + w0 * b[13] - w1 * b[12],
        )


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def add_forces_on_bodies(bodies, weights, on_middles, on_tip, forces):
    """Add dead forces to those on the joints, `forces` (4 N,).

    They act on the centres of gravity (N, 3), on the elements' middles (N, 3), and on the tip (3,).
    """
    n = weights.shape[0]
    f0, f1, f2 = on_tip[0], on_tip[1], on_tip[2]
    m0 = m1 = m2 = 0.0
    for i in range(n - 1, -1, -1):
        b = bodies[BODY * i : BODY * (i + 1)]
        w0, w1, w2 = weights[i, 0], weights[i, 1], weights[i, 2]
        c0, c1, c2 = on_middles[i, 0], on_middles[i, 1], on_middles[i, 2]
        m0 += b[13] * f2 - b[14] * f1 + b[16] * w2 - b[17] * w1 + b[28] * c2 - b[29] * c1
        m1 += b[14] * f0 - b[12] * f2 + b[17] * w0 - b[15] * w2 + b[29] * c0 - b[27] * c2
        m2 += b[12] * f1 - b[13] * f0 + b[15] * w1 - b[16] * w0 + b[27] * c1 - b[28] * c0
        f0, f1, f2 = f0 + w0 + c0, f1 + w1 + c1, f2 + w2 + c2
        forces[i] += b[0] * m0 + b[1] * m1 + b[2] * m2
        forces[n + i] += b[3] * m0 + b[4] * m1 + b[5] * m2
        forces[2 * n + i] += b[6] * m0 + b[7] * m1 + b[8] * m2
        forces[3 * n + i] += b[9] * f0 + b[10] * f1 + b[11] * f2


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def turn_inertia(root_tensors, bodies, turned):
    """Write the roots of the inertia in the clamp's frame (9 N,): B = A Rᵀ, with BᵀB = R I Rᵀ."""
    for i in range(root_tensors.shape[0]):
        b, a, out = bodies[BODY * i : BODY * (i + 1)], root_tensors[i], turned[9 * i : 9 * (i + 1)]
        x0, x1, x2 = b[18], b[19], b[20]
        y0, y1, y2 = b[21], b[22], b[23]
        z0, z1, z2 = b[24], b[25], b[26]
        for j in range(3):
            along_x, along_y, along_z = a[j, 0], a[j, 1], a[j, 2]
            out[3 * j] = along_x * x0 + along_y * y0 + along_z * z0
            out[3 * j + 1] = along_x * x1 + along_y * y1 + along_z * z1
            out[3 * j + 2] = along_x * x2 + along_y * y2 + along_z * z2


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def add_gyroscopic_forces_of_bodies(kernel, bodies, inertia, rates, roots, motion, forces):
    """Add ½ ∂/∂q (q̇ᵀ M q̇) to `forces` (4 N,), for joint rates (4 N,).

    `roots` is what `sweep_roots` found, `motion` the weighted velocities (3 N,) and spins (3 N,) if any.
    """
    n = kernel.masses.shape[0]
    p0 = p1 = p2 = l0 = l1 = l2 = 0.0
    for i in range(n - 1, -1, -1):
        b, v, root = (
            bodies[BODY * i : BODY * (i + 1)],
            motion[3 * i : 3 * (i + 1)],
            roots[6 * i : 6 * (i + 1)],
        )
        mass = kernel.root_masses[i]
        g0, g1, g2 = mass * v[0], mass * v[1], mass * v[2]
        l0 += b[13] * p2 - b[14] * p1 + b[16] * g2 - b[17] * g1
        l1 += b[14] * p0 - b[12] * p2 + b[17] * g0 - b[15] * g2
        l2 += b[12] * p1 - b[13] * p0 + b[15] * g1 - b[16] * g0
        if kernel.exact:
            a, h = inertia[9 * i : 9 * (i + 1)], motion[3 * (n + i) : 3 * (n + i + 1)]
            h0, h1, h2 = h[0], h[1], h[2]
            l0 += h0 * a[0] + h1 * a[3] + h2 * a[6]
            l1 += h0 * a[1] + h1 * a[4] + h2 * a[7]
            l2 += h0 * a[2] + h1 * a[5] + h2 * a[8]
        p0, p1, p2 = p0 + g0, p1 + g1, p2 + g2
        c0, c1, c2 = root[4] * p2 - root[5] * p1, root[5] * p0 - root[3] * p2, root[3] * p1 - root[4] * p0
        w0, w1, w2 = root[0], root[1], root[2]
        psi, theta, phi = rates[i], rates[n + i], rates[2 * n + i]
        if kernel.elements.by_vector:
            w0 += psi * b[0] + theta * b[3] + phi * b[6]
            w1 += psi * b[1] + theta * b[4] + phi * b[7]
            w2 += psi * b[2] + theta * b[5] + phi * b[8]
            k0, k1, k2 = l1 * w2 - l2 * w1 - c0, l2 * w0 - l0 * w2 - c1, l0 * w1 - l1 * w0 - c2
            # L in the element's frame, u and its rate, and their products: see `rotation_vector.tangent_rate`
            m0 = l0 * b[18] + l1 * b[19] + l2 * b[20]
            m1 = l0 * b[21] + l1 * b[22] + l2 * b[23]
            m2 = l0 * b[24] + l1 * b[25] + l2 * b[26]
            u0, u1, u2, r0, r1, r2 = b[30], b[31], b[32], phi, -theta, psi
            d0, d1, d2 = u1 * m2 - u2 * m1, u2 * m0 - u0 * m2, u0 * m1 - u1 * m0
            e0, e1, e2 = r1 * m2 - r2 * m1, r2 * m0 - r0 * m2, r0 * m1 - r1 * m0
            growth = 2.0 * (u0 * r0 + u1 * r1 + u2 * r2)
            of_c2, of_c3, at_c2, at_c3 = growth * b[35], growth * b[36], b[33], b[34]
            h0, h1, h2 = of_c3 * d0 + at_c3 * e0, of_c3 * d1 + at_c3 * e1, of_c3 * d2 + at_c3 * e2
            a0 = of_c2 * d0 + at_c2 * e0 + u1 * h2 - u2 * h1 + at_c3 * (r1 * d2 - r2 * d1)
            a1 = of_c2 * d1 + at_c2 * e1 + u2 * h0 - u0 * h2 + at_c3 * (r2 * d0 - r0 * d2)
            a2 = of_c2 * d2 + at_c2 * e2 + u0 * h1 - u1 * h0 + at_c3 * (r0 * d1 - r1 * d0)
            forces[i] += b[0] * k0 + b[1] * k1 + b[2] * k2 + a2
            forces[n + i] += b[3] * k0 + b[4] * k1 + b[5] * k2 - a1
            forces[2 * n + i] += b[6] * k0 + b[7] * k1 + b[8] * k2 + a0
        else:
            k0, k1, k2 = l1 * w2 - l2 * w1 - c0, l2 * w0 - l0 * w2 - c1, l0 * w1 - l1 * w0 - c2
            forces[i] += b[0] * k0 + b[1] * k1 + b[2] * k2
            w0, w1, w2 = w0 + psi * b[0], w1 + psi * b[1], w2 + psi * b[2]
            k0, k1, k2 = l1 * w2 - l2 * w1 - c0, l2 * w0 - l0 * w2 - c1, l0 * w1 - l1 * w0 - c2
            forces[n + i] += b[3] * k0 + b[4] * k1 + b[5] * k2
            w0, w1, w2 = w0 + theta * b[3], w1 + theta * b[4], w2 + theta * b[5]
            k0, k1, k2 = l1 * w2 - l2 * w1 - c0, l2 * w0 - l0 * w2 - c1, l0 * w1 - l1 * w0 - c2
            forces[2 * n + i] += b[6] * k0 + b[7] * k1 + b[8] * k2
            w0, w1, w2 = w0 + phi * b[6], w1 + phi * b[7], w2 + phi * b[8]
        if kernel.elements.axial:
            k0, k1, k2 = p1 * w2 - p2 * w1, p2 * w0 - p0 * w2, p0 * w1 - p1 * w0
            forces[3 * n + i] += b[9] * k0 + b[10] * k1 + b[11] * k2


@implements_rhs(RigidChain, inline=False)
def rigid_chain_rhs(kernel, t, x, dx, work):
    """Eqs. 6, 7 and 10."""
    r = kernel.modes.shape[0]
    n = kernel.masses.shape[0]
    bodies, jacobian = work[: BODY * n], work[BODY * n : (BODY + 6 * r) * n]
    scratch = work[(BODY + 6 * r) * n :]
    rates, motion = scratch[: 4 * n], scratch[4 * n : 10 * n]
    roots, forces, inertia = scratch[10 * n : 16 * n], scratch[16 * n : 20 * n], scratch[20 * n : 29 * n]
    mass = scratch[29 * n :]
    rows = 6 * n if kernel.exact else 3 * n
    sweep_bodies(kernel.modes, kernel.elements, x, bodies, scratch)
    if kernel.exact:
        turn_inertia(kernel.root_tensors, bodies, inertia)
    for k in range(r):
        column = jacobian[rows * k : rows * (k + 1)]
        sweep_column(kernel, bodies, inertia, kernel.first[k], kernel.modes[k], column)
        for j in range(k + 1):
            total = kernel.rotary_inertia[k, j]
            other = jacobian[rows * j : rows * (j + 1)]
            start = 3 * max(kernel.first[k], kernel.first[j])
            for i in range(start, 3 * n):
                total += column[i] * other[i]
            for i in range(3 * n + start, rows):
                total += column[i] * other[i]
            mass[r * k + j] = total
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
        add_forces_on_bodies(bodies, kernel.weights, kernel.unloaded, kernel.unloaded[0], forces)
    if kernel.gyroscopic:
        joint_values(kernel.modes, dx, rates)
        for i in range(rows):
            motion[i] = 0.0
        for k in range(r):
            column, rate = jacobian[rows * k : rows * (k + 1)], dx[k]
            for i in range(rows):
                motion[i] += column[i] * rate
        sweep_roots(bodies, kernel.elements.axial, rates, roots)
        add_gyroscopic_forces_of_bodies(kernel, bodies, inertia, rates, roots, motion, forces)
    add_projected(kernel.modes, forces, dx)
