"""Compiled equations of a chain in a plane: its absolute angles, one sweep out, one sweep back."""

from typing import NamedTuple

from numba import njit

from flexsurr.beam.linear_solve import solve_positive_definite
from flexsurr.beam.trigonometry import sine_cosine
from flexsurr.simulation.rhs import FLOATING_POINT, Array, implements_rhs


class PlanarMode(NamedTuple):
    """One mode of a chain in a plane: states (η, p)."""

    slopes: Array  # (N,) absolute angles for η = 1
    arms: Array  # (N,) l times the slopes [m]
    weights: Array  # (2, N) moment arms of gravity times the slopes [N m]
    mass: float  # of each element [kg]
    stiffness: float
    damping: float
    gyroscopic: bool
    heavy: bool


class PlanarChain(NamedTuple):
    """Any coordinates of a chain in a plane: states (η_1…η_r, p_1…p_r)."""

    slopes: Array  # (r, N) absolute angles for each η
    element_length: float  # [m]
    weights: Array  # (2, N) moment arms of gravity [N m]
    mass: float  # of each element [kg]
    stiffness: Array  # (r, r)
    damping: Array  # (r, r)
    gyroscopic: bool


@implements_rhs(PlanarMode)
def planar_mode_rhs(kernel, t, x, dx, work):
    """Eq. 10 for one mode: the gyroscopic term is η̇² Σ m J·J′ with J′ the tangent's own tangent."""
    eta = x[0]
    n = kernel.slopes.shape[0]
    for i in range(n):
        work[i], work[n + i] = sine_cosine(kernel.slopes[i] * eta)
    inertia = slope = weight = 0.0
    along = normal = along_2 = normal_2 = 0.0
    for i in range(n):
        sine, cosine = work[i], work[n + i]
        step_along, step_normal = -kernel.arms[i] * sine, kernel.arms[i] * cosine
        step_along_2, step_normal_2 = -kernel.slopes[i] * step_normal, kernel.slopes[i] * step_along
        x1, z1 = along + 0.5 * step_along, normal + 0.5 * step_normal
        x2, z2 = along_2 + 0.5 * step_along_2, normal_2 + 0.5 * step_normal_2
        inertia += x1 * x1 + z1 * z1
        slope += x1 * x2 + z1 * z2
        along += step_along
        normal += step_normal
        along_2 += step_along_2
        normal_2 += step_normal_2
    if kernel.heavy:
        for i in range(n):
            weight += kernel.weights[1, i] * work[n + i] - kernel.weights[0, i] * work[i]
    rate = x[1] / (kernel.mass * inertia)
    force = weight - kernel.stiffness * eta - kernel.damping * rate
    if kernel.gyroscopic:
        force += kernel.mass * slope * rate * rate
    dx[0] = rate
    dx[1] = force


def planar_work_size(elements: int, coordinates: int) -> int:
    """Scratch of `planar_chain_rhs`."""
    return 8 * elements + 2 * coordinates * elements + coordinates**2


@implements_rhs(PlanarChain)
def planar_chain_rhs(kernel, t, x, dx, work):
    """Eqs. 6, 7 and 10 in a plane."""
    r, n = kernel.slopes.shape
    sine, cosine, turning = work[:n], work[n : 2 * n], work[2 * n : 3 * n]
    spin, along, normal = work[3 * n : 4 * n], work[4 * n : 5 * n], work[5 * n : 6 * n]
    jacobian = work[6 * n : 6 * n + 2 * r * n]
    mass = work[6 * n + 2 * r * n :]
    planar_angles(kernel.slopes, x, sine, cosine)

    length = kernel.element_length
    for k in range(r):
        column = jacobian[2 * n * k : 2 * n * (k + 1)]
        u = w = 0.0
        for i in range(n):
            step_u, step_w = -length * kernel.slopes[k, i] * sine[i], length * kernel.slopes[k, i] * cosine[i]
            column[i], column[n + i] = u + 0.5 * step_u, w + 0.5 * step_w
            u += step_u
            w += step_w
        for j in range(k + 1):
            other = jacobian[2 * n * j : 2 * n * (j + 1)]
            total = 0.0
            for i in range(2 * n):
                total += column[i] * other[i]
            mass[r * k + j] = kernel.mass * total
        dx[k] = x[r + k]
    solve_positive_definite(mass, dx, r)

    for i in range(n):
        turning[i] = kernel.weights[1, i] * cosine[i] - kernel.weights[0, i] * sine[i]
    if kernel.gyroscopic:
        for i in range(n):
            spin[i] = along[i] = normal[i] = 0.0
        for k in range(r):
            for i in range(n):
                spin[i] += kernel.slopes[k, i] * dx[k]
                along[i] += jacobian[2 * n * k + i] * dx[k]
                normal[i] += jacobian[2 * n * k + n + i] * dx[k]
        u = w = 0.0  # momentum outboard, per element length
        for i in range(n - 1, -1, -1):
            step_u, step_w = length * kernel.mass * along[i], length * kernel.mass * normal[i]
            turning[i] -= spin[i] * (cosine[i] * (u + 0.5 * step_u) + sine[i] * (w + 0.5 * step_w))
            u += step_u
            w += step_w
    for k in range(r):
        force = 0.0
        for j in range(r):
            force -= kernel.stiffness[k, j] * x[j] + kernel.damping[k, j] * dx[j]
        for i in range(n):
            force += kernel.slopes[k, i] * turning[i]
        dx[r + k] = force


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True)
def planar_angles(slopes, x, sine, cosine):
    """Sines and cosines (N,) of the absolute angles at η = x[:r], slopes (r, N)."""
    r, n = slopes.shape
    for i in range(n):
        angle = 0.0
        for k in range(r):
            angle += slopes[k, i] * x[k]
        sine[i], cosine[i] = sine_cosine(angle)
