"""Trim, small motions about it, and doublets, with the derivatives of the airliner's own lattice."""

import dataclasses

import numpy as np
import pytest

from flexsurr.aerodynamics.features import LIFT, ROLL, SIDE, YAW
from flexsurr.config.flight import FlightCondition, TrimLimits
from flexsurr.flight.equations_of_motion import state_names
from flexsurr.flight.linear_aerodynamics import linear_aerodynamics
from flexsurr.flight.linearise import linearise, natural_modes, state_matrix
from flexsurr.flight.manoeuvres import doublet, fly, fly_stepped
from flexsurr.flight.model import FlightModel, features
from flexsurr.flight.trim import TrimNotFound, trim, trim_envelope

CRUISE = FlightCondition(mach=0.7, altitude_m=10000.0)
LATERAL = ("phi", "v", "p", "r")


@pytest.fixture(scope="module")
def cruise(gnba_modes, gnba_derivatives):
    return trim(FlightModel(gnba_modes, gnba_derivatives), CRUISE)


def test_in_trim_nothing_accelerates_and_the_wing_carries_the_weight(cruise):
    dx = cruise.model.derivative(0.0, cruise.state)
    assert dx[2:] == pytest.approx(np.zeros(26), abs=1e-8)
    assert dx[0] == pytest.approx(0.7 * 299.46, rel=1e-4)  # the speed of sound at 10 km, ISO 2533
    coefficients = cruise.model.aerodynamics(features(cruise.model, np.zeros(1), cruise.state[None]))[0]
    pressure = 0.5 * 0.41271 * dx[0] ** 2 * 116.0
    weight = 55764.0 * 9.80665
    assert pressure * coefficients[LIFT] + cruise.model.thrust_N * np.sin(cruise.alpha_rad) == pytest.approx(
        weight, rel=2e-3
    )
    assert 2.0 < np.degrees(cruise.alpha_rad) < 6.0
    assert cruise.eta[0] > 5.0  # the wing bends up


def test_trimmed_flight_stays_where_it_is(cruise):
    run = fly(cruise, None, duration_s=1.0)
    assert run.completed
    assert run.x[:, 2:] == pytest.approx(np.tile(cruise.state[2:], (len(run.t), 1)), abs=1e-6)


def test_an_aerodynamics_that_is_not_symmetric_is_trimmed_by_bank_aileron_and_rudder(
    cruise, gnba_derivatives
):
    about, value, slopes = gnba_derivatives.kernel
    skew = np.zeros(12)
    skew[[SIDE, ROLL, YAW]] = 1e-3, 1e-3, -1e-3
    skewed = linear_aerodynamics(about, value + skew, slopes)
    found = trim(cruise.model.with_aerodynamics(skewed), CRUISE)
    assert found.model.derivative(0.0, found.state)[2:] == pytest.approx(np.zeros(26), abs=1e-8)
    assert abs(found.model.controls[3]) > 1e-4
    assert found.model.controls[3] == -found.model.controls[4]


def test_where_no_trim_exists_the_error_says_where_and_what_is_left(cruise):
    with pytest.raises(
        TrimNotFound, match=r"Mach 0\.4 at 12000 m: no trim: alpha .* outside -5 to 10°.*w_dot"
    ):
        trim(cruise.model, FlightCondition(mach=0.4, altitude_m=12000.0))
    with pytest.raises(TrimNotFound, match=r"thrust .* outside 0 to 100 N; left at the limit: u_dot -"):
        trim(cruise.model, CRUISE, TrimLimits(thrust_N=(0.0, 100.0)))
    helpless = linear_aerodynamics(np.zeros(25), np.zeros(12), np.zeros((12, 25)))
    with pytest.raises(TrimNotFound, match=r"no trim found.*w_dot 9\.8"):
        trim(cruise.model.with_aerodynamics(helpless), CRUISE)


def test_an_envelope_holds_what_has_a_trim_and_reasons_for_the_rest(cruise):
    conditions = [FlightCondition(mach=mach, altitude_m=10000.0) for mach in (0.3, 0.65, 0.75)]
    found, missing = trim_envelope(cruise.model, conditions)
    assert [point.condition.mach for point in found] == [0.65, 0.75]
    assert len(missing) == 1
    assert found[0].alpha_rad > found[1].alpha_rad


def test_small_motions_follow_the_state_matrix(cruise):
    matrix, names = state_matrix(cruise.model, cruise.state)
    everything = list(state_names(8))
    kept = [everything.index(name) for name in names]
    rng = np.random.default_rng(3)
    small = 1e-3 * rng.normal(size=len(everything)) * np.where(np.arange(28) < 6, 0.01, 1.0)
    small[[0, 1, 2, 5]] = 0.0
    added = cruise.model.derivative(0.0, cruise.state + small) - cruise.model.derivative(0.0, cruise.state)
    assert added[kept] == pytest.approx(matrix @ small[kept], rel=1e-5, abs=1e-4)


def test_modes_are_named_by_the_states_that_take_part(cruise):
    modes = {mode.name: mode for mode in linearise(cruise)}
    rigid = ["short period", "phugoid", "dutch roll", "roll", "spiral"]
    assert list(modes) == rigid + [f"elastic {k}" for k in range(1, 9)]
    _, names = state_matrix(cruise.model, cruise.state)
    lateral = np.array([name in LATERAL for name in names])
    for name in ("dutch roll", "roll", "spiral"):
        assert modes[name].participation[lateral].sum() > 0.9
    for name in ("short period", "phugoid"):
        assert modes[name].participation[lateral].sum() < 1e-6
    assert modes["roll"].eigenvalue.imag == modes["spiral"].eigenvalue.imag == 0.0
    assert modes["short period"].eigenvalue.imag > 5.0 * modes["phugoid"].eigenvalue.imag > 0.0
    # the phugoid's frequency by Lanchester's energy balance, √2 g / V
    assert modes["phugoid"].eigenvalue.imag == pytest.approx(np.sqrt(2.0) * 9.80665 / 209.6, rel=0.25)
    omega = cruise.model.modes.omega_rad_s
    for k in (3, 4):  # those the aerodynamics does not know ring as in a vacuum
        exact = omega[k - 1] * complex(-0.02, np.sqrt(1.0 - 0.02**2))
        assert modes[f"elastic {k}"].eigenvalue == pytest.approx(exact, rel=1e-6)


def test_names_depend_neither_on_the_order_of_states_nor_on_their_units(cruise):
    matrix, names = state_matrix(cruise.model, cruise.state)
    rng = np.random.default_rng(5)
    order = rng.permutation(len(names))
    scale = 10.0 ** rng.uniform(-3.0, 3.0, len(names))
    other = (matrix * (scale / scale[:, None]))[np.ix_(order, order)]
    expected = {mode.name: mode.eigenvalue for mode in natural_modes(matrix, names)}
    found = {mode.name: mode.eigenvalue for mode in natural_modes(other, tuple(names[i] for i in order))}
    assert list(found) == list(expected)
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=1e-5, abs=1e-6)


def test_controls_turn_the_aircraft_the_way_they_are_meant_to(cruise):
    angle = np.radians(1.0)
    for control, rate, sign in (("elevator", 10, -1.0), ("aileron", 9, 1.0), ("rudder", 11, -1.0)):
        run = fly(cruise, doublet(control, angle), duration_s=1.5)
        assert sign * run.x[-1, rate] > 1e-4, control


@pytest.mark.parametrize("control", ["aileron", "rudder"])
def test_the_opposite_doublet_mirrors_the_flight(cruise, control):
    runs = [fly(cruise, doublet(control, sign * np.radians(2.0)), duration_s=2.0) for sign in (1.0, -1.0)]
    signs = np.ones(28)
    signs[[1, 3, 5, 7, 9, 11]] = -1.0
    signs[12:20] = signs[20:] = np.where(cruise.model.modes.symmetric, 1.0, -1.0)
    assert runs[1].x == pytest.approx(runs[0].x * signs, abs=1e-6)


def test_stepped_from_python_the_flight_is_the_same(cruise):
    pilot = doublet("rudder", np.radians(2.0))
    whole = fly(cruise, pilot, duration_s=3.0)
    stepped = fly_stepped(cruise, pilot, cruise.model.aerodynamics, duration_s=3.0)
    assert stepped.completed
    assert stepped.x == pytest.approx(whole.x, rel=1e-9, abs=1e-9)
    assert (stepped.t.tolist(), stepped.evaluations) == (whole.t.tolist(), whole.evaluations)
    with pytest.raises(ValueError, match=r"jumps at 0\.5 s, within a step of 0\.3 s"):
        fly_stepped(cruise, pilot, cruise.model.aerodynamics, duration_s=3.0, step_s=0.3)
    lost = fly_stepped(cruise, None, lambda u: np.full(12, np.nan), duration_s=1.0)
    assert (lost.completed, len(lost.t), lost.reason) == (False, 1, "not finite after 0 s")


def test_steps_half_as_long_change_a_flight_by_little(cruise):
    pilot = doublet("elevator", np.radians(2.0))
    coarse, fine = (fly(cruise, pilot, duration_s=1.0, step_s=step) for step in (0.005, 0.0025))
    assert coarse.x[:, 10] == pytest.approx(fine.x[::2, 10], abs=1e-5)


def test_doublets_break_time_where_they_jump(cruise):
    flown = dataclasses.replace(cruise.model, doublet=doublet("rudder", 0.1))
    assert flown.breakpoints == (0.5, 1.5, 2.5)
