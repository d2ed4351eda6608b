"""Planes of symmetry, by the signs that modes take in them."""

from pathlib import Path

import numpy as np
import pytest
from structures import CANTILEVER

from flexsurr.beam import mirrors, reduce, reduced_order
from flexsurr.config.along_span import FixedMass
from flexsurr.config.study import Reduction
from flexsurr.config.study_files import read_structure

WING = read_structure(Path(__file__).parents[2] / "config/structures/hale_wing.yaml").model_copy(
    update={"elements": 6}
)


def basis_of(structure, modes=6, **changed):
    structure = structure.model_copy(update=changed)
    return reduce(structure, Reduction(modes=modes, normalisation="mass"))


@pytest.mark.parametrize("rotation", ["vector", "sequence"])
def test_a_symmetric_wing_has_two_planes_and_its_mass_obeys_them(rotation):
    basis = basis_of(WING, joint_rotation=rotation)
    planes = mirrors(basis)
    # out of plane, out of plane, torsion, in plane, out of plane, out of plane
    kinds = "oot i oo".replace(" ", "")
    expected = [[1 if kind == "o" else -1 for kind in kinds], [1 if kind == "i" else -1 for kind in kinds]]
    np.testing.assert_array_equal(planes, expected)
    model = reduced_order(basis, "hamiltonian", "numpy")
    eta = np.random.default_rng(3).uniform(-1.0, 1.0, (4, 6)) / basis.unit_norms
    for signs in planes:
        here, there = model.mass_matrix(eta), model.mass_matrix(signs * eta)
        np.testing.assert_allclose(there, signs[:, None] * here * signs, atol=1e-9 * np.abs(here).max())


def test_an_offset_of_the_masses_leaves_one_plane():
    assert len(mirrors(basis_of(WING, centre_of_gravity_offset_m=0.1))) == 1


def test_a_cantilever_bends_up_as_it_bends_down():
    """In the plane that it bends in nothing changes its sign, which says nothing."""
    np.testing.assert_array_equal(mirrors(basis_of(CANTILEVER, 2)), [[-1.0, -1.0]])


def test_planes_that_say_the_same_are_one():
    assert mirrors(basis_of(WING, 3, joints=("torsion",))).tolist() == [[-1.0, -1.0, -1.0]]


def test_without_symmetry_there_is_none():
    engine = FixedMass(at_m=7.0, mass_kg=2.0, offset_m=(0.3, 0.2, -0.1))
    assert mirrors(basis_of(WING, 3, point_masses=(engine,))).shape == (0, 3)
