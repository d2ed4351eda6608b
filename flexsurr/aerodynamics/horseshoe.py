"""The velocity a horseshoe vortex induces, and what a lattice of them induces at many points.

Prandtl–Glauert: lengths along x are divided by β = √(1 − M²), and of the velocity that results the
component along x is divided by β (the normal wash stays the physical one, circulations are not rescaled).
"""

import math

import numpy as np
from numba import njit

from flexsurr.aerodynamics.lattice import Lattice
from flexsurr.config.aerodynamics import LARGEST_MACH
from flexsurr.simulation.rhs import FLOATING_POINT, Array

INLINED = {"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False}

# Relative; on the line of the bound vortex itself its own part is zero.
_ON_THE_LINE = 1e-12


@njit(**INLINED)
def horseshoe(ax, ay, az, bx, by, bz):
    """Velocity (three numbers) [1/m] induced by a horseshoe of unit circulation.

    (ax, ay, az) and (bx, by, bz) lead from the two ends of the bound vortex to the point; the legs trail
    along +x. Law of Biot and Savart for a segment and two half-lines (Katz, Plotkin, *Low-Speed
    Aerodynamics*, section 12.1).
    """
    a = math.sqrt(ax * ax + ay * ay + az * az)
    b = math.sqrt(bx * bx + by * by + bz * bz)
    ab = a * b
    d = ab + ax * bx + ay * by + az * bz
    k = (a + b) / (ab * d) if d > _ON_THE_LINE * ab else 0.0
    left = 1.0 / (a * (a - ax))
    right = 1.0 / (b * (b - bx))
    u = k * (ay * bz - az * by)
    v = k * (az * bx - ax * bz) + left * az - right * bz
    w = k * (ax * by - ay * bx) - left * ay + right * by
    quarter = 0.25 / math.pi
    return quarter * u, quarter * v, quarter * w


@njit(**INLINED)
def induced(ends, j, stretch, x, y, z):
    """Velocity induced at (x, y, z) [m] by horseshoe j of `ends` (6, N); `stretch` is 1/β."""
    u, v, w = horseshoe(
        (x - ends[0, j]) * stretch,
        y - ends[1, j],
        z - ends[2, j],
        (x - ends[3, j]) * stretch,
        y - ends[4, j],
        z - ends[5, j],
    )
    return u * stretch, v, w


def ends_of(lattice: Lattice) -> Array:
    """Both ends of the bound vortices, coordinate by coordinate: (6, N)."""
    return np.ascontiguousarray(np.concatenate([lattice.start, lattice.end], axis=1).T)


@njit(cache=True, fastmath=FLOATING_POINT, error_model="numpy")
def influence(ends, stretch, points):
    """Velocities (3, points, N) [1/m] at `points` (points, 3) for unit circulations."""
    result = np.empty((3, len(points), ends.shape[1]))
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for j in range(ends.shape[1]):
            u, v, w = induced(ends, j, stretch, x, y, z)
            result[0, i, j] = u
            result[1, i, j] = v
            result[2, i, j] = w
    return result


def stretch_of(mach: float) -> float:
    """1/β at a Mach number. Raises ValueError from 0.95 on, where Prandtl–Glauert fails."""
    if not 0.0 <= mach < LARGEST_MACH:
        raise ValueError(f"Mach {mach:g}: Prandtl–Glauert's rule holds from 0 to below {LARGEST_MACH}")
    return 1.0 / math.sqrt(1.0 - mach * mach)
