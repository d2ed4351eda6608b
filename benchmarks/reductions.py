"""Reductions of the wing that were tried for the reduced row of Table 3; none gives it (docs/differences.md).

Modes are those of eq. 9, with K alone, about one shape; frequencies those of the wing in their space.
Run: python benchmarks/reductions.py
"""

import numpy as np
from scipy.linalg import eigh
from wing import STRUCTURE

from flexsurr.beam import find_equilibrium, mass_matrix, natural_modes, stiffness_matrix
from flexsurr.config.load import TipForce
from flexsurr.config.structure import Structure
from flexsurr.evaluation.published import FREQUENCIES_RAD_S

SHOWN = 9
WITHOUT_OFFSET = STRUCTURE.model_copy(update={"centre_of_gravity_offset_m": 0.0})
PRINTED_INERTIA = STRUCTURE.model_copy(update={"torsional_inertia_per_length_kg_m": 0.75})
HEAVY = STRUCTURE.model_copy(update={"gravity_m_s2": 9.81})


def modes_about(structure: Structure, load: TipForce | None = None):
    """The shape of equilibrium (n,) under gravity and `load`, and the modes (n, n) about it, with K alone."""
    shape = find_equilibrium(structure, load)
    weightless = structure.model_copy(update={"gravity_m_s2": 0.0})
    return shape, natural_modes(weightless, shape)[1]


def frequencies(modes, shape=None):
    """ω [rad/s], ascending, of the wing in the space of `modes` (n, r) about `shape`, else about q = 0."""
    shape = np.zeros(STRUCTURE.coordinates) if shape is None else shape
    stiffness = modes.T @ stiffness_matrix(STRUCTURE) @ modes
    mass = modes.T @ mass_matrix(STRUCTURE, shape) @ modes
    return np.sqrt(eigh(stiffness, mass, eigvals_only=True))


def bending_and_torsion(bending: int, torsion: int):
    """The lowest pure bending and torsion modes of the wing without its offset (n, bending + torsion)."""
    modes = modes_about(WITHOUT_OFFSET)[1]
    bends = np.abs(modes[: STRUCTURE.elements]).max(axis=0) > np.abs(modes[STRUCTURE.elements :]).max(axis=0)
    return np.hstack([modes[:, bends][:, :bending], modes[:, ~bends][:, :torsion]])


def finer(elements: int):
    """ω [rad/s] of the full model with so many elements."""
    structure = STRUCTURE.model_copy(update={"elements": elements})
    return natural_modes(structure, np.zeros(structure.coordinates))[0]


def tried():
    """What was tried, and its frequencies [rad/s]."""
    yield "modes at q = 0, r = 9", frequencies(modes_about(STRUCTURE)[1][:, :9])
    heavy = modes_about(HEAVY)[1]
    yield "about the equilibrium under 9.81 m/s², r = 9", frequencies(heavy[:, :9])
    for force_N in (10.0, 50.0, 100.0):
        modes = modes_about(STRUCTURE, TipForce(force_N=force_N))[1]
        yield f"about a tip load of {force_N:g} N, r = 9", frequencies(modes[:, :9])
    load = TipForce(force_N=10.0)
    shape, modes = modes_about(STRUCTURE, load)
    yield "of 10 N, r = 3", frequencies(modes[:, :3])
    yield "under 9.81 m/s², r = 3", frequencies(heavy[:, :3])
    yield "about 10 N, frequencies there", frequencies(modes[:, :9], shape)
    yield "three bending and six torsion modes without offset", frequencies(bending_and_torsion(3, 6))
    yield (
        "modes of the wing with inertia 0.75 kg m, r = 9",
        frequencies(modes_about(PRINTED_INERTIA)[1][:, :9]),
    )
    yield "modes of the wing without offset, r = 12", frequencies(modes_about(WITHOUT_OFFSET)[1][:, :12])
    yield "full order, N = 32", finer(32)


def main() -> None:
    """Print the table."""
    full, reduced = FREQUENCIES_RAD_S["wing"]
    rows = [("published, full order", full), ("published, reduced order", reduced), *tried()]
    for name, omega in rows:
        print(f"| {name} | " + " | ".join(f"{value:.2f}" for value in omega[:SHOWN]) + " |")


if __name__ == "__main__":
    main()
