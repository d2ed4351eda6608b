"""Where the tip of a beam is, and how it is twisted, as expressions of the modal coordinates."""

import numpy as np

from flexsurr.beam import ModalBasis
from flexsurr.beam.chain import chain
from flexsurr.export.expressions import Value, concat, constant, each

ENTRIES = 9  # of a turn


def tip(basis: ModalBasis, eta: Value) -> tuple[Value, Value]:
    """Position (3,) [m] in the clamp's frame before it is turned, eq. 1, and twist () [rad].

    The expressions of `flexsurr.beam.tip_position` and `tip_twist`.
    """
    beam = chain(basis.structure)
    n = beam.elements
    modes = np.zeros((4 * n, eta.size))
    modes[beam.rows] = basis.modes
    joints = eta @ modes.T
    psi, theta, phi, stretch = (joints[k * n : (k + 1) * n] for k in range(4))
    cz, sz, cy, sy, cx, sx = (each(of, angle) for angle in (psi, theta, phi) for of in ("cos", "sin"))
    # R_z(ψ) R_y'(θ) R_x(φ) of all elements, entry by entry, and then element by element
    entries = concat([
        cz * cy, -sz * cx - cz * sy * sx, sz * sx - cz * sy * cx,
        sz * cy, cz * cx - sz * sy * sx, -cz * sx - sz * sy * cx,
        sy, cy * sx, cy * cx,
    ])  # fmt: skip
    turns = entries.reshape(ENTRIES, n).T
    frame = constant(beam.clamp)
    along = []
    for i in range(n):
        frame = frame @ turns[i].reshape(3, 3)
        along.append(frame[:, 0])
    steps = concat(along).reshape(n, 3)
    up = beam.clamp[:, 2] @ frame
    return (stretch + beam.element_length) @ steps, each("atan2", up[1], up[2])
