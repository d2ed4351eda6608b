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

    slopes: Array  # (P,) S, absolute angles for η = 1
    moments: Array  # (N,) l Σ m A over the masses from each element outwards [kg m²]
    weights: Array  # (2, N) moment arms of gravity [N m]
    inertia: float  # of each element about its own root, and rotary [kg m²]
    stiffness: float
    damping: float
    gyroscopic: bool
    heavy: bool


class PlanarChain(NamedTuple):
    """Any coordinates of a chain in a plane: states (η_1…η_r, p_1…p_r)."""

    slopes: Array  # (r, P) absolute angles for each η
    arms: Array  # (r, N) l times the slopes [m]
    weights: Array  # (2, N) moment arms of gravity [N m]
    root_masses: Array  # (N,) roots of the masses [kg½]
    root_arms: Array  # (N,) l times these
    places: Array  # (N,) where each lies, as part of the element's length
    inertia: Array  # (r, r) rotary [kg m²]
    stiffness: Array  # (r, r)
    damping: Array  # (r, r)
    gyroscopic: bool


@implements_rhs(PlanarMode)
def planar_mode_rhs(kernel, t, x, dx, work):
    """Eq. 10 for one mode. With e_i = S_i (−sin θ_i, cos θ_i) an element carries all outboard along l e_i.

    So two elements share l Σ m A of the outer one, whatever lies between, and

        M = I + 2 Σ c_i e_i · Σ_{j<i} e_j,     ½ dM/dη = Σ c_i (e_i turned by 90°) · Σ_{j<i} (S_i − S_j) e_j.
    """
    eta = x[0]
    slopes, moments = kernel.slopes, kernel.moments
    padded, n = slopes.shape[0], moments.shape[0]
    along, normal = work[:padded], work[padded : 2 * padded]
    for i in range(padded):
        sine, cosine = sine_cosine(slopes[i] * eta)
        along[i], normal[i] = slopes[i] * sine, slopes[i] * cosine
    # Two sums each, for they are chains of additions.
    inertia = inertia_2 = slope = slope_2 = 0.0
    sum_along = sum_normal = weighted_along = weighted_normal = 0.0
    for i in range(n):
        a, b, s = along[i], normal[i], slopes[i]
        of_a, of_b = moments[i] * a, moments[i] * b
        inertia += of_a * sum_along
        inertia_2 += of_b * sum_normal
        slope += of_b * (s * sum_along - weighted_along)
        slope_2 += of_a * (s * sum_normal - weighted_normal)
        sum_along += a
        sum_normal += b
        weighted_along += s * a
        weighted_normal += s * b
    weight = 0.0
    if kernel.heavy:
        for i in range(n):
            weight += kernel.weights[1, i] * normal[i] - kernel.weights[0, i] * along[i]
    rate = x[1] / (kernel.inertia + 2.0 * (inertia + inertia_2))
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

    for k in range(r):
        column = jacobian[2 * n * k : 2 * n * (k + 1)]
        u = w = 0.0
        for i in range(n):
            step_u, step_w = -kernel.arms[k, i] * sine[i], kernel.arms[k, i] * cosine[i]
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
            place, root = kernel.places[i], kernel.root_arms[i]
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
