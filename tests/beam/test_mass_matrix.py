import numpy as np
import pytest
from hypothesis import given
from structures import ALL_JOINTS, ENGINE, FORMS, SEEDS, any_structures, change, coordinates

from flexsurr.beam import mass_matrix, rotary_inertia
from flexsurr.beam.chain import chain
from flexsurr.beam.described import jacobians
from flexsurr.beam.described import mass_matrix as described_mass_matrix


@given(any_structures(elements=4), SEEDS)
def test_mass_matrix_is_symmetric_and_positive(structure, seed):
    mass = mass_matrix(structure, coordinates(structure, seed))
    np.testing.assert_allclose(mass, mass.T, rtol=0.0, atol=1e-14)
    # Torsion about an axis that carries no offset mass moves nothing but the rotary inertia, so all is
    # positive where that is.
    assert np.linalg.eigvalsh(mass).min() > 0.0


@given(any_structures(), SEEDS)
def test_both_mass_matrices_agree(structure, seed):
    q = coordinates(structure, seed)
    expected = described_mass_matrix(structure, q, jacobians(structure, q), rotary_inertia(structure))
    np.testing.assert_allclose(mass_matrix(structure, q), expected, atol=1e-14)


def test_all_mass_is_there_and_nothing_else():
    """Moved along x without a turn, M is the total mass: of the table, and of the body fixed to it."""
    for form in FORMS:
        for elements in (1, 7):
            structure = change(ALL_JOINTS, **form, elements=elements)
            table = structure.along_span
            total = 0.4 * 1.2 if table is None else np.trapezoid(table.mass_per_length_kg_m, table.stations_m)
            total += 0.2 if structure.point_masses else 0.0
            assert chain(structure).masses.sum() == pytest.approx(total, rel=1e-12)


def test_a_body_is_where_it_is_fixed_whatever_the_elements():
    """Of a rigid beam that turns about its clamp, inertia does not depend on how it is cut into elements."""
    inertia = []
    for elements in (1, 2, 5, 24):
        structure = change(
            ALL_JOINTS, elements=elements, mass_per_length_kg_m=1e-9, torsional_inertia_per_length_kg_m=1e-12,
            rotary_inertia="exact", point_masses=(ENGINE,), centre_of_gravity_offset_m=0.0,
        )  # fmt: skip
        first = np.eye(4 * elements)[::elements][:3]
        inertia.append(first @ mass_matrix(structure, np.zeros(4 * elements)) @ first.T)
    place = np.array([0.75, 0.02, -0.1])
    xy, xz, yz = ENGINE.products_of_inertia_kg_m2
    own = np.diag(ENGINE.inertia_kg_m2) - np.array([[0.0, xy, xz], [xy, 0.0, yz], [xz, yz, 0.0]])
    tensor = own + 0.2 * (place @ place * np.eye(3) - np.outer(place, place))
    axes = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])
    for found in inertia:
        np.testing.assert_allclose(found, axes @ tensor @ axes.T, rtol=1e-6)
