import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from structures import ALL_JOINTS, CANTILEVER, basis_of

from flexsurr.beam import draw_initial_conditions, stiffness_matrix
from flexsurr.beam.initial_conditions import initial_states
from flexsurr.config.study import InitialConditions

MODAL, JOINT = InitialConditions(kind="modal"), InitialConditions(kind="joint")


@given(st.sampled_from([MODAL, JOINT]), st.integers(0, 100), st.integers(0, 20), st.integers(0, 5))
def test_shards_are_parts_of_one_sequence(settings, seed, first, count):
    basis = basis_of(ALL_JOINTS)
    together = draw_initial_conditions(basis, settings, seed, 0, first + count)
    alone = draw_initial_conditions(basis, settings, seed, first, count)
    np.testing.assert_array_equal(alone, together[first:])


def test_modal_amplitudes_fill_their_ranges():
    states = draw_initial_conditions(basis_of(CANTILEVER, 2, "unit"), MODAL, 1, 0, 2000)
    eta, p = states[:, :2], states[:, 2:]
    assert np.abs(eta).max() <= np.pi / 9
    assert np.abs(eta).max() > 0.99 * np.pi / 9
    assert p.min() >= 0.0
    assert 1.49 < p.max() <= 1.5
    assert abs(np.corrcoef(states.T) - np.eye(4)).max() < 0.1


@pytest.mark.parametrize("settings", [MODAL, JOINT])
def test_motions_do_not_depend_on_the_normalisation(settings):
    unit, mass = basis_of(ALL_JOINTS, 3, "unit"), basis_of(ALL_JOINTS, 3, "mass")
    a = draw_initial_conditions(unit, settings, 7, 0, 20)
    b = draw_initial_conditions(mass, settings, 7, 0, 20)
    np.testing.assert_allclose(a[:, :3] @ unit.modes.T, b[:, :3] @ mass.modes.T, atol=1e-12)
    # Momenta are dual to the coordinates: p·η̇ is the same in both.
    np.testing.assert_allclose(a[:, 3:] / unit.unit_norms, b[:, 3:] / mass.unit_norms, atol=1e-12)


def test_joint_amplitudes_are_projected_with_the_springs():
    basis = basis_of(CANTILEVER, 10, "unit")
    states = draw_initial_conditions(basis, JOINT, 3, 0, 50)
    q = states[:, :10] @ basis.modes.T
    assert np.abs(q).max() <= np.pi / 9 * (1 + 1e-9)
    few = basis_of(CANTILEVER, 2, "unit")
    projected = draw_initial_conditions(few, JOINT, 3, 0, 50)[:, :2]
    stiffness = stiffness_matrix(CANTILEVER)
    # What the projection leaves out does no work on the modes.
    np.testing.assert_allclose((q - projected @ few.modes.T) @ stiffness @ few.modes, 0.0, atol=1e-9)


@pytest.mark.parametrize("normalisation", ["unit", "mass"])
@pytest.mark.parametrize(("higher_modes", "exponent"), [("as_energetic", 0), ("as_forced", 2)])
def test_higher_modes_have_their_share_of_the_energy(normalisation, higher_modes, exponent):
    """Where every coordinate, or momentum, is at the end of its range; the first mode's range is as given."""
    basis = basis_of(ALL_JOINTS.model_copy(update={"gravity_m_s2": 0.0}), 4, normalisation)
    ranges = InitialConditions(q_max_deg=5.0, p_max_kg_m2_s=0.3, higher_modes=higher_modes)
    alike = initial_states(basis, InitialConditions(q_max_deg=5.0, p_max_kg_m2_s=0.3), np.ones((1, 8)))
    (state,) = initial_states(basis, ranges, np.ones((1, 8)))
    eta, p = np.split(state, 2)
    np.testing.assert_allclose(state[[0, 4]], alike[0, [0, 4]])
    springs = np.diag(basis.stiffness)
    shares = (basis.omega_rad_s[0] / basis.omega_rad_s) ** exponent
    np.testing.assert_allclose(springs * eta**2, springs[0] * eta[0] ** 2 * shares)
    masses = springs / basis.omega_rad_s**2
    np.testing.assert_allclose(p**2 / masses, p[0] ** 2 / masses[0] * shares)


def test_joints_are_drawn_alike():
    with pytest.raises(ValueError, match="'as_forced' is not allowed with kind: joint; allowed: alike"):
        InitialConditions(kind="joint", higher_modes="as_forced")


def test_negative_numbers_are_refused():
    with pytest.raises(ValueError, match="must not be negative"):
        draw_initial_conditions(basis_of(CANTILEVER, 1), MODAL, 1, -1, 3)
