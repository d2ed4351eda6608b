import numpy as np
from hypothesis import given
from structures import SEEDS, coordinates, structures

from flexsurr.beam import mass_matrix, rotary_inertia
from flexsurr.beam.described import jacobians
from flexsurr.beam.described import mass_matrix as described_mass_matrix


@given(structures(elements=4), SEEDS)
def test_mass_matrix_is_symmetric_and_positive(structure, seed):
    mass = mass_matrix(structure, coordinates(structure, seed))
    np.testing.assert_allclose(mass, mass.T, rtol=0.0, atol=1e-15)
    # Torsion about an axis that carries no offset mass moves nothing but the rotary inertia, so all is
    # positive where that is.
    assert np.linalg.eigvalsh(mass).min() > 0.0


@given(structures(), SEEDS)
def test_both_mass_matrices_agree(structure, seed):
    q = coordinates(structure, seed)
    jacobian, _, _ = jacobians(structure, q)
    expected = described_mass_matrix(structure, jacobian, rotary_inertia(structure))
    np.testing.assert_allclose(mass_matrix(structure, q), expected, atol=1e-14)
