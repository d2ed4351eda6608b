"""Where the tip is, and what the weight has done, at many states: compiled, for judging whole responses."""

import numpy as np
from numba import njit

from flexsurr.beam.rigid_sweep import BODY, sweep_bodies
from flexsurr.simulation.rhs import FLOATING_POINT


@njit(fastmath=FLOATING_POINT, error_model="numpy", cache=True, nogil=True)
def sweep_tips(modes, elements, weights, x, tips, works):
    """Write the tip's positions (m, 3) [m] and Σ m g·r (m,) [J] of any chain at states `x` (m, 2r).

    `weights` (N, 3) [N] act on the centres of gravity; `modes` and `elements` as in `RigidChain`.
    """
    n = modes.shape[1] // 4
    bodies, scratch = np.empty(BODY * n), np.empty(10 * n)
    for k in range(len(x)):
        sweep_bodies(modes, elements, x[k], bodies, scratch)
        work = 0.0
        along_x = along_y = along_z = 0.0
        for i in range(n):
            b = BODY * i
            work += weights[i, 0] * (along_x + bodies[b + 15])
            work += weights[i, 1] * (along_y + bodies[b + 16])
            work += weights[i, 2] * (along_z + bodies[b + 17])
            along_x += bodies[b + 12]
            along_y += bodies[b + 13]
            along_z += bodies[b + 14]
        tips[k, 0], tips[k, 1], tips[k, 2] = along_x, along_y, along_z
        works[k] = work
