"""What a structure's file cannot show: joints that move nothing, a shape that gives way, units mistaken."""

import numpy as np
from scipy.linalg import LinAlgError, eigh, eigvalsh

from flexsurr.beam.chain import stiffness_matrix
from flexsurr.beam.clamp_rotation import turning_clamp
from flexsurr.beam.equilibrium import EquilibriumNotFound, find_equilibrium
from flexsurr.beam.kinematics import mass_matrix
from flexsurr.config.load import Load
from flexsurr.config.structure import FEW, Structure

_SINGULAR = 1e-12  # of a mass matrix whose diagonal is 1; where it is more, ω₁ is right to 5e-4
LEAST_RAD_S, MOST_RAD_S = 0.02, 5e4
"""Between which the first frequency of a slender structure is expected; it may well be another."""


def check_structure(structure: Structure) -> None:
    """ValueError, one line, for a structure with which nothing can be simulated."""
    rest = np.zeros(structure.coordinates)
    mass = mass_matrix(structure, rest)
    sizes = np.sqrt(np.diag(mass))
    scaled = mass / np.where(sizes > 0.0, sizes, 1.0) / np.where(sizes > 0.0, sizes, 1.0)[:, None]
    least, motions = eigh(scaled, subset_by_index=[0, 0])
    if not least[0] > _SINGULAR:
        if structure.elements > FEW:
            raise ValueError(
                f"elements: {structure.elements} is not allowed; allowed: fewer, such as {FEW}, for the mass "
                "matrix is singular to rounding"
            )
        kinds = np.repeat(structure.ordered_joints, structure.elements)
        moved = kinds[np.argmax(np.abs(motions[:, 0]))]
        raise ValueError(
            f"joints: '{moved}' moves no mass of its own; allowed: with mass or inertia that only it moves, "
            "such as torsional_inertia_per_length_kg_m, or without this joint"
        )
    if structure.gravity_m_s2 > 0.0:
        try:
            find_equilibrium(structure)
        except EquilibriumNotFound as error:
            raise ValueError(
                f"gravity_m_s2: {error}; allowed: a stiffer or lighter structure, or less gravity"
            ) from None


def check_load(structure: Structure, load: Load) -> None:
    """ValueError, one line, for a clamp that cannot turn as the load says."""
    turning_clamp(structure, load.parts)


def unit_hint(structure: Structure) -> str:
    """A line where the first frequency is out of any reason, as mistaken units make it; or nothing."""
    rest = np.zeros(structure.coordinates)
    try:
        first = float(np.sqrt(eigvalsh(stiffness_matrix(structure), mass_matrix(structure, rest))[0]))
    except LinAlgError:
        odd = f"the mass matrix of {structure.name} is singular to rounding"
    else:
        if LEAST_RAD_S <= first <= MOST_RAD_S:
            return ""
        odd = f"the first frequency of {structure.name} is {first:.3g} rad/s"
    return f"{odd}: are lengths in m, masses in kg/m, stiffnesses in N m² and inertia in kg m?"
