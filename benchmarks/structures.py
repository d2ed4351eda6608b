"""Structures of every form: how fast they converge, what they err by, what their right-hand sides cost.

Run alone on the machine:  python benchmarks/structures.py
The tables of docs/structures.md are its output.
"""

from pathlib import Path

import numpy as np
from beam_right_hand_sides import COMPILED, COMPILED_CALLS, caller
from timing import compare

from flexsurr.beam import find_equilibrium, natural_modes, reduce, reduced_order, tip_position
from flexsurr.config.along_span import AlongSpan
from flexsurr.config.load import TipForce
from flexsurr.config.structure import Structure
from flexsurr.config.study import Reduction
from flexsurr.config.study_files import read_structure

STRUCTURES = Path(__file__).parents[1] / "config/structures"
COUNTS = (8, 16, 32)
FINEST = 64
REPEATS = 30

# Patil's wing (1999) under 20 N at the tip.
WING = {
    "name": "Patil's wing",
    "length_m": 16.0,
    "joints": ("in_plane", "out_of_plane", "torsion"),
    "mass_per_length_kg_m": 0.75,
    "bending_stiffness_in_plane_N_m2": 4e6,
    "bending_stiffness_out_of_plane_N_m2": 2e4,
    "torsional_stiffness_N_m2": 1e4,
    "torsional_inertia_per_length_kg_m": 0.1,
}
LOAD = TipForce(force_N=20.0)

# Bathe and Bolourchi's 45° bend (1979), in inches and pounds.
BEND = {
    "name": "45° bend",
    "length_m": 25.0 * np.pi,
    "joints": ("in_plane", "out_of_plane", "torsion", "axial"),
    "mass_per_length_kg_m": 1.0,
    "torsional_inertia_per_length_kg_m": 1.0,
    "bending_stiffness_in_plane_N_m2": 1e7 / 12.0,
    "bending_stiffness_out_of_plane_N_m2": 1e7 / 12.0,
    "torsional_stiffness_N_m2": 1e7 / 12.0,
    "axial_stiffness_N": 1e7,
    "along_span": AlongSpan(stations_m=(0.0, 25.0 * np.pi), axis_psi_deg=(0.0, 45.0)),
}


def deformed(
    values: dict, elements: int, joint_rotation: str, load: TipForce
) -> tuple[np.ndarray, np.ndarray]:
    """Displacement of the tip, and frequencies about the deformed shape."""
    structure = Structure(**values, elements=elements, joint_rotation=joint_rotation)
    q = find_equilibrium(structure, load)
    moved = tip_position(structure, q) - tip_position(structure, 0.0 * q)
    return moved, natural_modes(structure, q, load)[0]


def convergence() -> None:
    """Errors against the finest chain of rotation vectors, in percent."""
    finest, exact = deformed(WING, FINEST, "vector", LOAD)
    print("| joints | N | tip, % of its way | ω₁, % | ω₂, % | ω₃, % |")
    print("|---|---|---|---|---|---|")
    for joint_rotation in ("vector", "sequence"):
        for count in COUNTS:
            tip, omega = deformed(WING, count, joint_rotation, LOAD)
            off = 100.0 * np.linalg.norm(tip - finest) / np.linalg.norm(finest)
            errors = 100.0 * np.abs(omega[:3] / exact[:3] - 1.0)
            print(f"| {joint_rotation} | {count} | {off:.2g} |", " | ".join(f"{e:.2g}" for e in errors), "|")
    print("\n| 45° bend, 600 lb | N | x, in | y, in | z, in |\n|---|---|---|---|---|")
    for joint_rotation in ("vector", "sequence"):
        for count in COUNTS:
            tip, _ = deformed(BEND, count, joint_rotation, TipForce(force_N=600.0))
            print(f"| {joint_rotation} | {count} |", " | ".join(f"{part:.2f}" for part in tip), "|")


def costs() -> None:
    """Microseconds of a compiled right-hand side of three modes, the gyroscopic term kept."""
    wing = read_structure(STRUCTURES / "wing.yaml")
    values = wing.model_dump()
    share = np.array([0.0, 0.5, 1.0])
    table = AlongSpan(stations_m=tuple(16.0 * share), mass_per_length_kg_m=tuple(1.0 - 0.5 * share))
    varying = {**values, "mass_per_length_kg_m": None, "along_span": table}
    cantilever = read_structure(STRUCTURES / "cantilever.yaml")
    taper = AlongSpan(stations_m=tuple(share), mass_per_length_kg_m=tuple(0.3 - 0.2 * share))
    cases = {
        "cantilever, 1 mode": (cantilever, 1),
        "with properties along the span, 1 mode": (
            Structure(**{**cantilever.model_dump(), "mass_per_length_kg_m": None, "along_span": taper}),
            1,
        ),
        "cantilever, 3 modes": (cantilever, 3),
        "wing as it is": (wing, 3),
        "with properties along the span": (Structure(**varying), 3),
        "with rotation vectors": (Structure(**{**varying, "joint_rotation": "vector"}), 3),
        "with exact inertia, too": (
            Structure(**{**varying, "joint_rotation": "vector", "rotary_inertia": "exact"}),
            3,
        ),
        "tapered_wing": (read_structure(STRUCTURES / "tapered_wing.yaml"), 3),
    }
    callers = {}
    for name, (structure, modes) in cases.items():
        basis = reduce(structure, Reduction(modes=modes, normalisation="mass"))
        callers[name] = caller(reduced_order(basis, "hamiltonian", COMPILED), COMPILED)
    print("\n| compiled right-hand side, reduced | µs |\n|---|---|")
    timings = compare("right-hand side of structures", callers, REPEATS, counts=COMPILED_CALLS)
    for name, timing in timings.items():
        print(f"| {name} | {1e6 * timing.median_s:.3g} ± {1e6 * timing.spread_s:.1g} |")


if __name__ == "__main__":
    convergence()
    costs()
