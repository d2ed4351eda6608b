"""Laws that hold for any state of flight: mirror images, rigid motion in the guise of modes, small inputs."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from wings import (
    AIRLINER,
    MIDDLES,
    RANGES,
    flexible_airliner,
    in_body_axes,
    rigid_body,
    symmetric_and_antisymmetric,
)

from flexsurr.aerodynamics.features import (
    ALPHA,
    COEFFICIENTS,
    FEATURES,
    FIRST_ETA,
    FIRST_ETA_RATE,
    RATE_P,
    RATE_R,
)
from flexsurr.aerodynamics.forces import add_body
from flexsurr.aerodynamics.mach_grid import fixed_machs, mach_grid
from flexsurr.aerodynamics.quadratic import quadratic
from flexsurr.aerodynamics.sampling import linear_in_modes
from flexsurr.aerodynamics.vortex_lattice import frozen, rebuilt

GRID = mach_grid(0.3, 0.8, nodes=3, points=2)
UNITS = arrays(np.float64, len(FEATURES), elements=st.floats(-1.0, 1.0))


def features(units, mach: float = 0.5):
    u = MIDDLES + RANGES * units
    u[0] = mach
    return u


# Names whose sign the mirror image changes, and the pairs it exchanges.
ODD_FEATURES = ("beta", "p_over_V", "r_over_V", "delta_r")
ODD_COEFFICIENTS = ("C_Y", "C_l", "C_n", "C_phi_4", "C_phi_5", "C_phi_6")


def mirrored(u):
    image = u.copy()
    for name in ODD_FEATURES:
        image[FEATURES.index(name)] *= -1.0
    for stem in ("eta_{}", "eta_dot_{}_over_V"):
        for k in (4, 5, 6):  # antisymmetric modes
            image[FEATURES.index(stem.format(k))] *= -1.0
    for control in ("delta_e", "delta_a"):
        left, right = FEATURES.index(f"{control}_left"), FEATURES.index(f"{control}_right")
        image[left], image[right] = u[right], u[left]
    return image


AIRLINER_WITH_MODES = flexible_airliner(symmetric_and_antisymmetric)
EXACT = frozen(AIRLINER_WITH_MODES, GRID)
LINEAR = frozen(AIRLINER_WITH_MODES, GRID, "linear")
QUADRATIC = quadratic(AIRLINER_WITH_MODES, GRID)
SIZE = np.abs(EXACT(MIDDLES + RANGES * np.random.default_rng(0).uniform(-1.0, 1.0, (50, 25)))).max(axis=0)


@settings(max_examples=50)
@given(units=UNITS, mach=st.floats(0.3, 0.8))
def test_a_mirrored_flight_has_mirrored_forces(units, mach):
    u = features(units, mach)
    signs = np.array([-1.0 if name in ODD_COEFFICIENTS else 1.0 for name in COEFFICIENTS])
    np.testing.assert_array_less(np.abs(EXACT(mirrored(u)) - signs * EXACT(u)), 1e-11 * SIZE)


@settings(max_examples=50)
@given(units=UNITS, mach=st.floats(0.3, 0.8))
def test_the_quadratic_form_is_the_lattice_with_a_linear_boundary_condition(units, mach):
    u = features(units, mach)
    np.testing.assert_array_less(np.abs(QUADRATIC(u) - LINEAR(u)), 1e-12 * SIZE)


@settings(max_examples=20)
@given(units=UNITS, size=st.sampled_from([0.1, 0.01, 0.001]))
def test_the_boundary_conditions_differ_by_the_second_order(units, size):
    u = features(size * units)
    np.testing.assert_array_less(np.abs(EXACT(u) - LINEAR(u)), (2.0 * size**2 + 1e-12) * SIZE)


@settings(max_examples=10)
@given(units=UNITS, node=st.integers(0, 2))
def test_frozen_matrices_are_exact_at_their_mach_numbers(units, node):
    u = features(units, float(GRID.machs()[node]))
    for frozen_form, condition in ((EXACT, "exact"), (LINEAR, "linear")):
        again = rebuilt(AIRLINER_WITH_MODES, condition)(u)
        np.testing.assert_allclose(frozen_form(u), again, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize(("feature", "value"), [("mach", 1.2), ("alpha", np.nan), ("eta_1", np.inf)])
def test_nonsense_is_no_number_and_no_error(feature, value):
    u = features(np.zeros(25))
    u[FEATURES.index(feature)] = value
    for form in (EXACT, QUADRATIC, rebuilt(AIRLINER_WITH_MODES)):
        assert not np.isfinite(form(u)).all()


def test_interpolation_between_mach_numbers_converges():
    u = features(np.random.default_rng(1).uniform(-1.0, 1.0, 25), 0.62)
    truth = rebuilt(AIRLINER_WITH_MODES)(u)
    coarse, fine = (
        np.abs(frozen(AIRLINER_WITH_MODES, mach_grid(0.3, 0.8, nodes, 3))(u) - truth) for nodes in (5, 17)
    )
    assert np.all(fine < 0.1 * coarse + 1e-12 * SIZE)
    assert np.all(fine < 1e-5 * SIZE)


RIGID = flexible_airliner(rigid_body)
RIGID_LATTICE = frozen(RIGID, fixed_machs([0.5]))
RIGID_LINEAR = frozen(RIGID, fixed_machs([0.5]), "linear")


@settings(max_examples=25)
@given(units=UNITS, size=st.floats(-1.0, 1.0))
def test_rates_of_rigid_modes_are_body_rates(units, size):
    # (p, q, r) about the body's axes are (−p, q, −r) about the geometry's
    for axis, sign in enumerate((-1.0, 1.0, -1.0)):
        u = features(units)
        v = u.copy()
        rate = RATE_P + axis
        v[rate] += 0.003 * size
        u[FIRST_ETA_RATE + 3 + axis] += sign * 0.003 * size
        np.testing.assert_allclose(RIGID_LATTICE(u), RIGID_LATTICE(v), rtol=0.0, atol=1e-10)
    assert rate == RATE_R


@settings(max_examples=25)
@given(units=UNITS, size=st.floats(-0.1, 0.1))
def test_heaving_is_an_angle_of_attack(units, size):
    u = features(units)
    v = u.copy()
    v[ALPHA] += size
    u[FIRST_ETA_RATE + 2] -= size  # up at w is air coming down at w
    difference = in_body_axes(u, RIGID_LINEAR(u)) - in_body_axes(v, RIGID_LINEAR(v))
    # the parasite drag and the fuselage's moment go with the centre of gravity's own motion
    for state, sign in ((u, -1.0), (v, 1.0)):
        body = np.zeros(12)
        add_body(False, RIGID_LINEAR.kernel.panels, state, body)
        difference += sign * body
    np.testing.assert_allclose(difference, 0.0, atol=1e-11)


@settings(max_examples=25)
@given(units=UNITS)
def test_generalised_forces_of_rigid_modes_are_forces_and_moments(units):
    u = features(units)
    c = in_body_axes(u, RIGID_LATTICE(u))
    body = np.zeros(12)
    add_body(True, RIGID_LATTICE.kernel.panels, u, body)
    lengths = np.array([1.0, 1.0, 1.0, RIGID.reference.span, RIGID.reference.chord, RIGID.reference.span])
    signs = np.array([-1.0, 1.0, -1.0, -1.0, 1.0, -1.0])
    np.testing.assert_allclose(c[6:], signs * lengths * (c - body)[:6], rtol=0.0, atol=1e-11)


def slope(output: str, feature: str, step: float = 1e-4) -> float:
    u = features(np.zeros(25))
    v = u.copy()
    v[FEATURES.index(feature)] += step
    at = COEFFICIENTS.index(output)
    return float((EXACT(v)[at] - EXACT(u)[at]) / step)


@settings(max_examples=20)
@given(units=UNITS, size=st.floats(-1.0, 1.0))
def test_linear_in_the_modes_it_touches_the_lattice_at_rest_and_adds_up(units, size):
    u = features(units)
    modal = np.zeros(25)
    modal[FIRST_ETA:] = u[FIRST_ETA:]
    rest = u - modal
    points = np.array([rest, rest + modal, rest + size * modal, rest + 1e-3 * modal, rest - 1e-3 * modal])
    c = linear_in_modes(EXACT, points)
    np.testing.assert_array_less(np.abs(c[0] - EXACT(rest)), 1e-13 * SIZE)
    np.testing.assert_array_less(np.abs(c[2] - (c[0] + size * (c[1] - c[0]))), 1e-9 * SIZE)
    # the rest of second order is one millionth of that of the whole motion
    second = np.abs(EXACT(points[3]) + EXACT(points[4]) - 2.0 * c[0])
    np.testing.assert_array_less(np.abs(c[3] - EXACT(points[3])), second + 1e-9 * SIZE)


def test_controls_act_in_the_documented_sense():
    assert slope("C_L", "alpha") > 4.0
    assert slope("C_m", "i_t") < 0.0
    assert slope("C_m", "delta_e_left") < 0.0
    assert slope("C_m", "delta_e_right") < 0.0
    assert slope("C_l", "delta_a_left") > 0.0
    assert slope("C_l", "delta_a_right") < 0.0
    assert slope("C_n", "delta_r") < 0.0
    assert slope("C_Y", "delta_r") > 0.0
    assert slope("C_Y", "beta") < 0.0
    assert slope("C_l", "p_over_V") < 0.0
    assert slope("C_m", "q_over_V") < 0.0
    assert slope("C_n", "r_over_V") < 0.0


def test_the_fuselage_destabilises_and_altitude_adds_friction():
    u = features(np.zeros(25))
    bare = np.zeros(12)
    add_body(True, EXACT.kernel.panels, u, bare)
    assert bare[0] < 0.0
    higher = u.copy()
    higher[FEATURES.index("altitude_m")] += 5000.0
    thin = np.zeros(12)
    add_body(True, EXACT.kernel.panels, higher, thin)
    assert thin[0] < bare[0]  # a lower Reynolds number
    u[ALPHA] = u[FEATURES.index("beta")] = 0.1
    tilted = np.zeros(12)
    add_body(True, EXACT.kernel.panels, u, tilted)
    assert tilted[4] > 0.0 > tilted[5]
    volume = 0.8 * 0.25 * np.pi * AIRLINER.fuselage.diameter_m**2 * AIRLINER.published.fuselage_length_m
    assert 0.9 < EXACT.kernel.panels.munk_volume / volume < 1.0
