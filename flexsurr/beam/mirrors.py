"""Mirror images: changes of sign of the coordinates under which the mass matrix only changes signs.

A straight wing that is its own mirror image in the plane of x and z moves in mirrored ways alike: with S of
+1 and −1 on the diagonal, M(S η) = S M(η) S. An entry of M then holds only what changes its sign as the entry
does.
"""

import numpy as np

from flexsurr.beam.kinematics import mass_matrix
from flexsurr.beam.projection import ModalBasis
from flexsurr.config.structure import Joint
from flexsurr.simulation.rhs import Array

PLANES: tuple[frozenset[Joint], ...] = (
    frozenset({"in_plane", "torsion"}),
    frozenset({"out_of_plane", "torsion"}),
)
"""The joints whose angles change sign in the planes of x and z, and of x and y."""

PROBES = 3  # configurations at which the law is tried
PROBED = 0.3  # their size, in unit-norm modes [rad]
ROUNDING = 1e-9


def mirrors(basis: ModalBasis) -> Array:
    """(k, r) signs of the modal coordinates in each plane of symmetry; k is 0 to 2.

    A plane counts where every mode is its own image but for the sign, and the law holds at configurations
    drawn at random; and where it says more than nothing, and more than the plane before.
    """
    kinds = np.repeat(basis.structure.ordered_joints, basis.structure.elements)
    found: list[Array] = []
    for plane in PLANES:
        of_joints = np.where(np.isin(kinds, list(plane)), -1.0, 1.0)
        signs = _signs_of_modes(basis.modes, of_joints)
        known = [np.ones(basis.modes.shape[1]), *found]
        if signs is None or any(np.array_equal(signs, other) for other in known):
            continue
        if _holds(basis, signs):
            found.append(signs)
    return np.array(found).reshape(-1, basis.modes.shape[1])


def _signs_of_modes(modes: Array, of_joints: Array) -> Array | None:
    """(r,) the sign that each mode (n, r) takes with those of the joints (n,); None where one is mixed."""
    overlap = np.sum(modes * of_joints[:, None] * modes, axis=0) / np.sum(modes * modes, axis=0)
    return np.sign(overlap) if np.all(np.abs(np.abs(overlap) - 1.0) < ROUNDING) else None


def _holds(basis: ModalBasis, signs: Array) -> bool:
    generator = np.random.default_rng(0)
    eta = PROBED * generator.uniform(-1.0, 1.0, (PROBES, signs.size)) / basis.unit_norms
    here, there = (
        basis.modes.T @ mass_matrix(basis.structure, at @ basis.modes.T) @ basis.modes
        for at in (eta, signs * eta)
    )
    image = signs[:, None] * here * signs
    return bool(np.allclose(there, image, rtol=ROUNDING, atol=ROUNDING * np.abs(here).max()))
