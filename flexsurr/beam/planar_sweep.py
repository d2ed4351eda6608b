"""Compiled equations of a chain in a plane: its absolute angles, one sweep out, one sweep back.

Rows over the elements are padded with zeros to P, a multiple of `LANES`, so that the sines and cosines
fill whole vector registers; N is the true number of elements. The columns of the Jacobian are running sums
of hops, each from one mass to the next: past the rest of the element before, and along its own. Hops need
nothing of one another, so they fill registers too; what is left for the sweep are additions.
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
    behind: Array  # (2, P) of each hop the part in the element before [m], and its slope times that
    ahead: Array  # (2, P) and the part in its own, likewise
    weights: Array  # (2, P) moment arms of gravity times the slopes [N m]
    masses: Array  # (P,) [kg]
    elements: int  # N
    inertia: float  # rotary [kg m²]
    stiffness: float
    damping: float
    gyroscopic: bool
    heavy: bool


class PlanarChain(NamedTuple):
    """Any coordinates of a chain in a plane: states (η_1…η_r, p_1…p_r)."""

    slopes: Array  # (r, P) absolute angles for each η
    behind: Array  # (r, P) of each hop the part in the element before [m], for each η
    ahead: Array  # (r, P) and the part in its own
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
    padded = kernel.slopes.shape[0]
    sine, cosine = work[: padded + 1], work[padded + 1 : 2 * padded + 2]  # an element before the first, too
    hops = work[2 * padded + 2 : 6 * padded + 2]
    along, normal = hops[:padded], hops[padded : 2 * padded]
    along_2, normal_2 = hops[2 * padded : 3 * padded], hops[3 * padded :]
    sine[0] = cosine[0] = 0.0
    for i in range(padded):
        sine[i + 1], cosine[i + 1] = sine_cosine(kernel.slopes[i] * eta)
    for i in range(padded):
        behind, ahead = kernel.behind[0, i], kernel.ahead[0, i]
        behind_2, ahead_2 = kernel.behind[1, i], kernel.ahead[1, i]
        along[i] = behind * sine[i] + ahead * sine[i + 1]
        normal[i] = behind * cosine[i] + ahead * cosine[i + 1]
        along_2[i] = behind_2 * sine[i] + ahead_2 * sine[i + 1]
        normal_2[i] = behind_2 * cosine[i] + ahead_2 * cosine[i + 1]
    # J is (−along, normal) and J′ is (−normal_2, −along_2). Two sums each, for they are chains of additions.
    inertia = inertia_2 = slope = slope_2 = 0.0
    at_along = at_normal = at_along_2 = at_normal_2 = 0.0
    for i in range(kernel.elements):
        at_along += along[i]
        at_normal += normal[i]
        at_along_2 += along_2[i]
        at_normal_2 += normal_2[i]
        weighted_along, weighted_normal = kernel.masses[i] * at_along, kernel.masses[i] * at_normal
        inertia += weighted_along * at_along
        inertia_2 += weighted_normal * at_normal
        slope += weighted_along * at_normal_2
        slope_2 += weighted_normal * at_along_2
    weight = 0.0
    if kernel.heavy:
        for i in range(padded):
            weight += kernel.weights[1, i] * cosine[i + 1] - kernel.weights[0, i] * sine[i + 1]
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
    return 6 * padded_length(elements) + 2 + 2 * coordinates * elements + coordinates**2


@implements_rhs(PlanarChain, inline=False)
def planar_chain_rhs(kernel, t, x, dx, work):
    """Eqs. 6, 7 and 10 in a plane."""
    r, padded = kernel.slopes.shape
    n = kernel.weights.shape[1]
    # an element before the first, too
    sines, cosines = work[: padded + 1], work[padded + 1 : 2 * padded + 2]
    sine, cosine = sines[1:], cosines[1:]
    turning, scratch = work[2 * padded + 2 : 2 * padded + 2 + n], work[3 * padded + 2 :]
    spin, along, normal = scratch[:n], scratch[n : 2 * n], scratch[2 * n : 3 * n]
    jacobian = scratch[3 * n : 3 * n + 2 * r * n]
    mass = scratch[3 * n + 2 * r * n :]
    sines[0] = cosines[0] = 0.0
    planar_angles(kernel.slopes, x, sine, cosine)

    length = kernel.element_length
    for k in range(r):
        column = jacobian[2 * n * k : 2 * n * (k + 1)]
        behind, ahead = kernel.behind[k], kernel.ahead[k]
        for i in range(n):
            column[i] = -behind[i] * sines[i] - ahead[i] * sines[i + 1]
            column[n + i] = behind[i] * cosines[i] + ahead[i] * cosines[i + 1]
        u = w = 0.0
        for i in range(n):
            u += column[i]
            w += column[n + i]
            column[i], column[n + i] = kernel.root_masses[i] * u, kernel.root_masses[i] * w
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
