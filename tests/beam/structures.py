"""Structures for the tests of the beam, and hypothesis strategies for them."""

import math
from itertools import combinations

import numpy as np
from hypothesis import strategies as st

from flexsurr.beam import ModalBasis, mass_matrix, reduce
from flexsurr.config.along_span import AlongSpan, FixedMass
from flexsurr.config.load import DistributedForce, Spread, TipForce
from flexsurr.config.structure import JOINTS, Structure
from flexsurr.config.study import Reduction

CANTILEVER = Structure(
    name="cantilever",
    length_m=1.0,
    elements=10,
    joints=("out_of_plane",),
    mass_per_length_kg_m=0.2,
    bending_stiffness_out_of_plane_N_m2=50.0,
)

ALL_JOINTS = Structure(
    name="all joints",
    length_m=1.2,
    elements=3,
    joints=JOINTS,
    mass_per_length_kg_m=0.4,
    bending_stiffness_in_plane_N_m2=80.0,
    bending_stiffness_out_of_plane_N_m2=50.0,
    torsional_stiffness_N_m2=20.0,
    axial_stiffness_N=600.0,
    torsional_inertia_per_length_kg_m=0.01,
    chord_m=0.2,
    centre_of_gravity_offset_m=0.03,
    joint_rotation="sequence",
    rotary_inertia="constant",
    clamp_psi_deg=10.0,
    clamp_theta_deg=20.0,
    clamp_phi_deg=-30.0,
    gravity_m_s2=9.81,
)

TAPER = AlongSpan(
    stations_m=(0.0, 0.5, 1.2),
    mass_per_length_kg_m=(0.5, 0.4, 0.2),
    bending_stiffness_out_of_plane_N_m2=(60.0, 50.0, 20.0),
    torsional_inertia_per_length_kg_m=(0.02, 0.01, 0.005),
)
"""A beam that gets lighter and softer outwards, at its end less so."""

BEND = AlongSpan(
    stations_m=(0.0, 0.5, 1.2),
    mass_per_length_kg_m=(0.5, 0.4, 0.2),
    torsional_inertia_per_length_kg_m=(0.02, 0.01, 0.005),
    inertia_about_y_per_length_kg_m=(0.004, 0.003, 0.001),
    chord_m=(0.3, 0.2, 0.2),
    centre_of_gravity_offset_m=(0.0, 0.03, -0.05),
    elastic_axis_offset_m=(0.0, 0.01, -0.02),
    axis_psi_deg=(0.0, 20.0, 40.0),
    axis_theta_deg=(5.0, 5.0, 20.0),
    axis_phi_deg=(0.0, 10.0, 30.0),
)
"""Everything that may vary does; its axis is swept, bent and twisted."""

ENGINE = FixedMass(
    at_m=0.7,
    mass_kg=0.2,
    offset_m=(0.05, 0.02, -0.1),
    inertia_kg_m2=(0.01, 0.012, 0.015),
    products_of_inertia_kg_m2=(0.001, 0.002, -0.001),
)

_IN_TABLE = {
    "mass_per_length_kg_m": None,
    "bending_stiffness_out_of_plane_N_m2": None,
    "torsional_inertia_per_length_kg_m": 0.0,
    "centre_of_gravity_offset_m": 0.0,
    "chord_m": 0.1,
}
"""What is left to a table: the defaults of these keys."""

FORMS: tuple[dict[str, object], ...] = (
    {},
    {"joint_rotation": "vector"},
    {"rotary_inertia": "exact", "inertia_about_y_per_length_kg_m": 0.003},
    {"joint_rotation": "vector", "rotary_inertia": "exact"},
    {**_IN_TABLE, "along_span": TAPER},
    {**_IN_TABLE, "along_span": TAPER, "joint_rotation": "vector", "rotary_inertia": "exact"},
    {
        **_IN_TABLE,
        "bending_stiffness_out_of_plane_N_m2": 50.0,
        "along_span": BEND,
        "rotary_inertia": "exact",
        "point_masses": (ENGINE,),
    },
    {
        **_IN_TABLE,
        "bending_stiffness_out_of_plane_N_m2": 50.0,
        "along_span": BEND,
        "joint_rotation": "vector",
        "rotary_inertia": "exact",
        "point_masses": (ENGINE,),
    },
)
"""The study's own form first, then each that differs from it, and all together."""

SUBSETS = [subset for size in range(1, 5) for subset in combinations(JOINTS, size)]


def change(structure: Structure, **values: object) -> Structure:
    """A checked copy of `structure` with some values replaced."""
    return Structure(**{**structure.model_dump(), **values})


def structures(**fixed: object) -> st.SearchStrategy[Structure]:
    """Chains of any joints, clamp, offset, gravity and damping; `fixed` overrides."""
    angle = st.floats(-180.0, 180.0)
    damping = st.sampled_from([0.0, 0.01])
    drawn = {
        "elements": st.integers(1, 5),
        "joints": st.sampled_from(SUBSETS),
        "centre_of_gravity_offset_m": st.sampled_from([0.0, 0.03, -0.15]),
        "clamp_psi_deg": angle,
        "clamp_theta_deg": angle,
        "clamp_phi_deg": angle,
        "gravity_m_s2": st.sampled_from([0.0, 9.81]),
        "clamp_spring": st.sampled_from(["tip_deflection", "half_element"]),
        **{f"damping_{joint}_s": damping for joint in JOINTS},
    }
    drawn.update({key: st.just(value) for key, value in fixed.items()})
    return st.fixed_dictionaries(drawn).map(lambda values: change(ALL_JOINTS, **values))


def any_structures(**fixed: object) -> st.SearchStrategy[Structure]:
    """The same in any form: with properties along the span, bodies fixed to it, a bent axis, any joints."""
    of_form = st.sampled_from(FORMS)
    return st.tuples(structures(**fixed), of_form).map(lambda drawn: change(drawn[0], **drawn[1]))


def coordinates(structure: Structure, seed: int) -> np.ndarray:
    """Random joint coordinates q (n,): large turns, stretches well within an element's length."""
    amplitudes = [0.05 if joint == "axial" else 0.7 for joint in structure.ordered_joints]
    random = np.random.default_rng(seed)
    return np.repeat(amplitudes, structure.elements) * random.uniform(-1.0, 1.0, structure.coordinates)


def state(system: Structure | ModalBasis, seed: int) -> np.ndarray:
    """A random state (q, p) or (η, p) with rates of order one.

    Momenta drawn as such would be wild where the mass matrix is near singular.
    """
    structure = system if isinstance(system, Structure) else system.structure
    modes = np.eye(structure.coordinates) if isinstance(system, Structure) else system.modes
    eta = np.linalg.lstsq(modes, coordinates(structure, seed), rcond=None)[0]
    rates = np.linalg.lstsq(modes, coordinates(structure, seed + 1), rcond=None)[0]
    return np.concatenate([eta, modes.T @ mass_matrix(structure, modes @ eta) @ modes @ rates])


def basis_of(structure: Structure, modes: int = 3, normalisation: str = "mass"):
    """The first modes, or as many as there are."""
    return reduce(structure, Reduction(modes=min(modes, structure.coordinates), normalisation=normalisation))


def tip_force(x: float, y: float, z: float) -> TipForce:
    """A constant force at the tip by its components [N]."""
    return TipForce(force_N=math.hypot(x, y, z), direction=(x, y, z) if any((x, y, z)) else (0.0, 0.0, 1.0))


def uniform_force(x: float, y: float, z: float, **more: object) -> DistributedForce:
    """A force per length by its components [N/m]."""
    spreads = {f"along_{axis}": Spread(force_N_m=size) for axis, size in zip("xyz", (x, y, z), strict=True)}
    return DistributedForce(**spreads, **more)


SEEDS = st.integers(0, 2**32 - 1)
