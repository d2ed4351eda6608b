import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from structures import (
    ALL_JOINTS,
    CANTILEVER,
    FORMS,
    SUBSETS,
    any_structures,
    basis_of,
    change,
    structures,
    tip_force,
)

from flexsurr.beam import (
    EquilibriumNotFound,
    find_equilibrium,
    full_order,
    mass_matrix,
    natural_modes,
    reduce,
    reduced_order,
    stiffness_matrix,
    tip_position,
)
from flexsurr.config.study import Reduction

# Roots of cos β cosh β = −1: ω = β² √(EI/μL⁴) of the exact cantilever.
EXACT = np.array([1.8751040687, 4.6940911330, 7.8547574382]) ** 2 * np.sqrt(50.0 / 0.2)


def test_frequencies_converge_to_the_exact_beam():
    counts = np.array([10, 20, 40, 80])
    errors = []
    for count in counts:
        structure = change(CANTILEVER, elements=int(count))
        omega, _ = natural_modes(structure, np.zeros(count))
        errors.append(np.abs(omega[:3] / EXACT - 1.0))
    orders = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert (orders > 1.9).all()
    assert errors[0][0] < 2e-3


def test_the_published_reduced_cantilever():
    """K_r, M_r(0), ω and the tip at η = 0.3 of the study's beam, r = 1, unit-norm mode."""
    structure = change(CANTILEVER, clamp_spring="half_element")
    basis = reduce(structure, Reduction(modes=1))
    np.testing.assert_allclose(basis.stiffness, [[555.1946]], rtol=1e-7)
    mass = basis.modes.T @ mass_matrix(structure, np.zeros(10)) @ basis.modes
    np.testing.assert_allclose(mass, [[0.180597]], atol=5e-7)
    np.testing.assert_allclose(basis.omega_rad_s, [55.4456], atol=5e-5)
    np.testing.assert_allclose(
        tip_position(structure, basis.modes @ [0.3]), [0.81996, 0.0, 0.52738], atol=5e-6
    )


@given(any_structures())
def test_modes_diagonalise_mass_and_stiffness(structure):
    structure = change(structure, gravity_m_s2=0.0)
    q = np.zeros(structure.coordinates)
    omega, modes = natural_modes(structure, q)
    np.testing.assert_allclose(modes.T @ mass_matrix(structure, q) @ modes, np.eye(len(q)), atol=1e-9)
    stiffness = modes.T @ stiffness_matrix(structure) @ modes
    np.testing.assert_allclose(stiffness, np.diag(omega**2), rtol=0.0, atol=1e-9 * omega[-1] ** 2)
    assert (np.diff(omega) >= 0.0).all()


@pytest.mark.parametrize("about_equilibrium", [False, True])
@pytest.mark.parametrize("joints", SUBSETS)
def test_frequencies_are_those_of_the_linearised_model(joints, about_equilibrium):
    check_linearised(change(ALL_JOINTS, joints=joints, gravity_m_s2=9.81 if about_equilibrium else 0.0))


@pytest.mark.parametrize("form", range(1, len(FORMS)))
def test_so_are_those_of_any_form(form):
    check_linearised(change(ALL_JOINTS, **FORMS[form]))


def check_linearised(structure):
    """Eigenvalues of the full-order model's Jacobian, by central differences, are ±iω."""
    q = find_equilibrium(structure)
    omega, _ = natural_modes(structure, q)
    model = full_order(structure, "hamiltonian", "compiled")
    x = np.concatenate([q, 0.0 * q])
    n, step = len(q), 1e-5
    columns = [
        (model.derivative(0.0, x + step * e) - model.derivative(0.0, x - step * e)) / (2.0 * step)
        for e in np.eye(2 * n)
    ]
    blocks = np.array(columns).T
    squares = np.linalg.eigvals(-blocks[n:, :n] @ blocks[:n, n:])
    np.testing.assert_allclose(np.sort(squares.real), omega**2, rtol=1e-6, atol=1e-7 * omega[-1] ** 2)


def test_a_tip_load_shifts_the_frequencies():
    load = tip_force(0.0, 0.0, 100.0)
    unloaded, _ = natural_modes(CANTILEVER, np.zeros(10))
    loaded, _ = natural_modes(CANTILEVER, find_equilibrium(CANTILEVER, load), load)
    assert abs(loaded[0] / unloaded[0] - 1.0) > 0.01


def test_compression_beyond_buckling_is_unstable():
    with pytest.raises(EquilibriumNotFound, match="unstable"):
        natural_modes(CANTILEVER, np.zeros(10), tip_force(-200.0, 0.0, 0.0))


@settings(max_examples=30)
@given(structures(), st.sampled_from(["unit", "mass"]), st.sampled_from(["undeformed", "equilibrium"]))
def test_a_basis_holds_the_first_modes(structure, normalisation, about):
    r = min(3, structure.coordinates)
    basis = reduce(structure, Reduction(modes=r, normalisation=normalisation, about=about))
    unloaded = structure if about == "equilibrium" else change(structure, gravity_m_s2=0.0)
    omega, _ = natural_modes(unloaded, basis.equilibrium)
    np.testing.assert_allclose(basis.omega_rad_s, omega[:r])
    np.testing.assert_allclose(basis.unit_norms, np.linalg.norm(basis.modes, axis=0))
    if normalisation == "unit":
        np.testing.assert_allclose(basis.unit_norms, 1.0)
    else:
        mass = basis.modes.T @ mass_matrix(structure, basis.equilibrium) @ basis.modes
        np.testing.assert_allclose(mass, np.eye(r), atol=1e-9)
    stiffness = basis.modes.T @ stiffness_matrix(structure) @ basis.modes
    np.testing.assert_allclose(basis.stiffness, stiffness, atol=1e-12 * np.abs(stiffness).max())


def test_modes_lift_the_tip_or_are_positive():
    _, modes = natural_modes(CANTILEVER, np.zeros(10))
    arms = np.arange(10, 0, -1) * 0.1
    assert (arms @ modes > 0.0).all()
    sideways = change(CANTILEVER, joints=("in_plane",), bending_stiffness_in_plane_N_m2=50.0)
    _, modes = natural_modes(sideways, np.zeros(10))
    assert (np.take_along_axis(modes, np.abs(modes).argmax(axis=0)[None], axis=0) > 0.0).all()


def test_a_reduction_to_all_modes_is_the_full_order_model():
    basis = basis_of(ALL_JOINTS, 12)
    x = np.random.default_rng(0).uniform(-0.5, 0.5, 24)
    full = np.concatenate([basis.modes @ x[:12], np.linalg.solve(basis.modes.T, x[12:])])
    reduced = reduced_order(basis, "hamiltonian", "compiled").derivative(0.0, x)
    expected = full_order(ALL_JOINTS, "hamiltonian", "compiled").derivative(0.0, full)
    back = np.concatenate([basis.modes @ reduced[:12], np.linalg.solve(basis.modes.T, reduced[12:])])
    for part in (slice(0, 12), slice(12, 24)):
        scale = np.abs(expected[part]).max()
        np.testing.assert_allclose(back[part], expected[part], rtol=0.0, atol=1e-9 * scale)


def test_more_modes_than_coordinates_are_refused():
    with pytest.raises(ValueError, match="modes: 11 modes asked of cantilever, which has 10 coordinates"):
        reduce(CANTILEVER, Reduction(modes=11))


def test_an_equilibrium_of_the_wrong_length_is_refused():
    with pytest.raises(ValueError, match="equilibrium has shape"):
        natural_modes(CANTILEVER, np.zeros(3))
