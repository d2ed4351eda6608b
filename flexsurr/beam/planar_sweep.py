"""Compiled equations of a chain in a plane: its absolute angles, one sweep out, one sweep back.

Rows over the elements are padded with zeros to P, a multiple of `LANES`, so that the sines and cosines
fill whole vector registers; N is the true number of elements.
"""

from typing import NamedTuple

from numba import njit

from flexsurr.beam.trigonometry import sine_cosine
from flexsurr.simulation.linear_solvers import solve_positive_definite
from flexsurr.simulation.rhs import FLOATING_POINT, Array, implements_rhs

LANES = 4  # doubles in a 256-bit register


class PlanarMode(NamedTuple):
    """One mode of a chain in a plane: states (η, p)."""

    slopes: Array  # (P,) absolute angles for η = 1
    arms: Array  # (P,) l times the slopes [m]
    weights: Array  # (2, N) moment arms of gravity over the element's length [N]
    masses: Array  # (N,) [kg]
    places: Array  # (N,) where each lies, as part of the element's length
    inertia: float  # rotary [kg m²]
    stiffness: float
    damping: float
    gyroscopic: bool
    heavy: bool


class PlanarChain(NamedTuple):
    """Any coordinates of a chain in a plane: states (η_1…η_r, p_1…p_r)."""

    slopes: Array  # (r, P) absolute angles for each η
    element_length: float  # [m]
    weights: Array  # (2, N) moment arms of gravity [N m]
    root_masses: Array  # (N,) roots of the masses [kg½]
    places: Array  # (N,) where each lies, as part of the element's length
    inertia: Array  # (r, r) rotary [kg m²]
    stiffness: Array  # (r, r)
    damping: Array  # (r, r)
    gyroscopic: bool


@implements_rhs(PlanarMode)
def planar_mode_rhs(kernel, t, x, dx, work):
    """Eq. 10 for one mode: the gyroscopic term is η̇² Σ m J·J′ with J′ the tangent's own tangent."""
    eta = x[0]
    slopes, arms, masses, places = kernel.slopes, kernel.arms, kernel.masses, kernel.places
    padded = slopes.shape[0]
    n = kernel.weights.shape[1]
    steps_along, steps_normal = work[:padded], work[padded : 2 * padded]
    for i in range(padded):
        sine, cosine = sine_cosine(slopes[i] * eta)
        steps_along[i], steps_normal[i] = arms[i] * sine, arms[i] * cosine
    # J is (−along, normal) and J′ is (−normal_2, −along_2). Two sums each, for they are chains of additions.
    weight = 0.0
    inertia = inertia_2 = slope = slope_2 = 0.0
    along = normal = along_2 = normal_2 = 0.0
    for i in range(n):
        step_along, step_normal = steps_along[i], steps_normal[i]
        step_along_2, step_normal_2 = slopes[i] * step_along, slopes[i] * step_normal
        place, mass = places[i], masses[i]
        at_along, at_normal = along + place * step_along, normal + place * step_normal
        weighted_along, weighted_normal = mass * at_along, mass * at_normal
        inertia += weighted_along * at_along
        inertia_2 += weighted_normal * at_normal
        slope += weighted_along * (normal_2 + place * step_normal_2)
        slope_2 += weighted_normal * (along_2 + place * step_along_2)
        along += step_along
        normal += step_normal
        along_2 += step_along_2
        normal_2 += step_normal_2
    if kernel.heavy:
        for i in range(n):
            weight += kernel.weights[1, i] * steps_normal[i] - kernel.weights[0, i] * steps_along[i]
    rate = x[1] / (kernel.inertia + (inertia + inertia_2))
    force = weight - kernel.stiffness * eta - kernel.damping * rate
    if kernel.gyroscopic:
        force += (slope - slope_2) * rate * rate
    dx[0] = rate
    dx[1] = force


def padded_length(elements: int) -> int:
    """P, the number of elements rounded up to whole registers."""
    return -(-elements // LANES) * LANES


def planar_work_size(elements: int, coordinates: int) -> int:
    """Scratch of `planar_chain_rhs`."""
    return 6 * padded_length(elements) + 2 * coordinates * elements + coordinates**2


@implements_rhs(PlanarChain, inline=False)
def planar_chain_rhs(kernel, t, x, dx, work):
    """Eqs. 6, 7 and 10 in a plane."""
    r, padded = kernel.slopes.shape
    n = kernel.weights.shape[1]
    sine, cosine, turning = work[:padded], work[padded : 2 * padded], work[2 * padded : 2 * padded + n]
    scratch = work[3 * padded :]
    spin, along, normal = scratch[:n], scratch[n : 2 * n], scratch[2 * n : 3 * n]
    jacobian = scratch[3 * n : 3 * n + 2 * r * n]
    mass = scratch[3 * n + 2 * r * n :]
    planar_angles(kernel.slopes, x, sine, cosine)

    length = kernel.element_length
    for k in range(r):
        column = jacobian[2 * n * k : 2 * n * (k + 1)]
        u = w = 0.0
        for i in range(n):
            step_u, step_w = -length * kernel.slopes[k, i] * sine[i], length * kernel.slopes[k, i] * cosine[i]
            place, root = kernel.places[i], kernel.root_masses[i]
            column[i], column[n + i] = root * (u + place * step_u), root * (w + place * step_w)
            u += step_u
            w += step_w
        for j in range(k + 1):
            other = jacobian[2 * n * j : 2 * n * (j + 1)]
            total = 0.0
            for i in range(2 * n):
                total += column[i] * other[i]
            mass[r * k + j] = total + kernel.inertia[k, j]
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
            place, root = kernel.places[i], length * kernel.root_masses[i]
            step_u, step_w = root * along[i], root * normal[i]
            turning[i] -= spin[i] * (cosine[i] * (u + place * step_u) + sine[i] * (w + place * step_w))
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
    """Sines and cosines (P,) of the absolute angles at η = x[:r], slopes (r, P)."""
    r, padded = slopes.shape
    for i in range(padded):
        sine[i] = 0.0
    for k in range(r):
        row, eta = slopes[k], x[k]
        for i in range(padded):
            sine[i] += row[i] * eta
    for i in range(padded):
        sine[i], cosine[i] = sine_cosine(sine[i])
