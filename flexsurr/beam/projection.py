"""q = Φ η: the coordinates in which a model of the chain is written.

The full-order model is the case Φ = 1, so every implementation of the dynamics is written once.
"""

from dataclasses import dataclass

import numpy as np

from flexsurr.beam.chain import chain, damping_matrix, stiffness_matrix
from flexsurr.config.structure import Structure
from flexsurr.simulation.rhs import Array

_ROUNDING = 1e-12  # of a mode's components, beside its largest


@dataclass(frozen=True, eq=False)
class ModalBasis:
    """The first r modes of a structure about an equilibrium, and the reduced springs and dampers.

    q = Φ η as in eq. 10, measured from the undeformed shape whatever the equilibrium; a mode of unit norm
    has η in rad (with axial joints: rad and m alike), a mass-normalised one in kg½ m.
    """

    structure: Structure
    equilibrium: Array  # (n,) shape about which the modes were taken
    modes: Array  # (n, r) Φ
    stiffness: Array  # (r, r) Φᵀ K Φ
    damping: Array  # (r, r) Φᵀ C Φ
    omega_rad_s: Array  # (r,) natural frequencies
    unit_norms: Array  # (r,) Euclidean norm of each mode; 1 for modes of unit norm
    normalisation: str  # "unit" or "mass"

    @classmethod
    def of(
        cls, structure: Structure, equilibrium: Array, modes: Array, omega_rad_s: Array, normalisation: str
    ) -> "ModalBasis":
        """The basis of these modes (n, r), with what follows from them."""
        return cls(
            structure=structure,
            equilibrium=equilibrium,
            modes=np.ascontiguousarray(modes),
            stiffness=modes.T @ stiffness_matrix(structure) @ modes,
            damping=modes.T @ damping_matrix(structure) @ modes,
            omega_rad_s=omega_rad_s,
            unit_norms=np.linalg.norm(modes, axis=0),
            normalisation=normalisation,
        )


@dataclass(frozen=True, eq=False)
class Projection:
    """Coordinates η (r,) with q = Φ η, their springs and dampers, and the names of the states (η, p)."""

    structure: Structure
    modes: Array  # (n, r) Φ
    stiffness: Array  # (r, r) Φᵀ K Φ
    damping: Array  # (r, r) Φᵀ C Φ
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]

    @property
    def coordinates(self) -> int:
        """r, half the number of states."""
        return int(self.modes.shape[1])

    @property
    def only_twists(self) -> bool:
        """Whether the tip stays where it is, whatever the coordinates: torsion alone, of a straight axis."""
        if not self.structure.straight:
            return False
        kinds = np.repeat(self.structure.ordered_joints, self.structure.elements)
        others = np.abs(self.modes[kinds != "torsion"])
        return bool(np.all(others < _ROUNDING * np.max(np.abs(self.modes))))

    def joints(self, x: Array) -> Array:
        """Joint coordinates q (..., n) of the states x (..., 2r)."""
        return np.asarray(x)[..., : self.coordinates] @ self.modes.T


def projection(system: Structure | ModalBasis) -> Projection:
    """The joint coordinates of a structure, or the modal coordinates of a basis."""
    if isinstance(system, ModalBasis):
        return _modal(system)
    return _joints(system)


def _joints(structure: Structure) -> Projection:
    n = structure.elements
    names = [f"{joint}_{i}" for joint in structure.ordered_joints for i in range(1, n + 1)]
    axial = [joint == "axial" for joint in structure.ordered_joints for _ in range(n)]
    units_q = ["m" if along else "rad" for along in axial]
    units_p = ["kg m/s" if along else "kg m²/s" for along in axial]
    return Projection(
        structure=structure,
        modes=np.eye(chain(structure).coordinates),
        stiffness=stiffness_matrix(structure),
        damping=damping_matrix(structure),
        state_names=(*(f"q_{name}" for name in names), *(f"p_{name}" for name in names)),
        state_units=(*units_q, *units_p),
    )


def _modal(basis: ModalBasis) -> Projection:
    r = basis.modes.shape[1]
    unit_q, unit_p = ("rad", "kg m²/s") if basis.normalisation == "unit" else ("kg½ m", "kg½ m/s")
    return Projection(
        structure=basis.structure,
        modes=basis.modes,
        stiffness=basis.stiffness,
        damping=basis.damping,
        state_names=(*(f"eta_{k}" for k in range(1, r + 1)), *(f"p_{k}" for k in range(1, r + 1))),
        state_units=(unit_q,) * r + (unit_p,) * r,
    )
