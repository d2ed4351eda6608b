"""Where the tip of a beam is, and how it is twisted, as expressions of the modal coordinates."""

import numpy as np

from flexsurr.beam import ModalBasis
from flexsurr.beam.chain import chain
from flexsurr.beam.rotation_vector import stumpff
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
    entries = _of_vectors(phi, -theta, psi) if beam.by_vector else _of_sequences(psi, theta, phi)
    turns = concat(entries).reshape(ENTRIES, n).T
    frame = constant(beam.clamp)
    along = []
    for i in range(n):
        turn = turns[i].reshape(3, 3)
        # constants first with what varies: a product of two constants has no place in a batch
        frame = frame @ (turn if beam.turns is None else constant(beam.turns[i]) @ turn)
        along.append(frame @ beam.stretches[i])
    steps = concat(along).reshape(n, 3)
    up = beam.clamp[:, 2] @ (frame @ constant(beam.undeformed.T))
    return (stretch + np.linalg.norm(beam.spans, axis=1)) @ steps, each("atan2", up[1], up[2])


def _of_sequences(psi: Value, theta: Value, phi: Value) -> list[Value]:
    """R_z(ψ) R_y'(θ) R_x(φ) of all elements (n,), entry by entry."""
    cz, sz, cy, sy, cx, sx = (each(of, angle) for angle in (psi, theta, phi) for of in ("cos", "sin"))
    return [
        cz * cy, -sz * cx - cz * sy * sx, sz * sx - cz * sy * cx,
        sz * cy, cz * cx - sz * sy * sx, -cz * sx - sz * sy * cx,
        sy, cy * sx, cy * cx,
    ]  # fmt: skip


def _of_vectors(x: Value, y: Value, z: Value) -> list[Value]:
    """The rotations by the vectors (x, y, z) of all elements (n,), entry by entry: 1 + c₁ [u] + c₂ [u]²."""
    c1, c2, *_ = stumpff(x * x + y * y + z * z)
    return [
        1.0 - c2 * (y * y + z * z), c2 * x * y - c1 * z, c2 * x * z + c1 * y,
        c2 * x * y + c1 * z, 1.0 - c2 * (x * x + z * z), c2 * y * z - c1 * x,
        c2 * x * z - c1 * y, c2 * y * z + c1 * x, 1.0 - c2 * (x * x + y * y),
    ]  # fmt: skip
