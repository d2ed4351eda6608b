"""Laws of motion without air, and the parts that aerodynamics, thrust and controls add to it."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexsurr.aerodynamics.features import COEFFICIENTS, CONTROLS, FEATURES, LIFT
from flexsurr.aerodynamics.standard_atmosphere import density, speed_of_sound
from flexsurr.aerodynamics.vortex_lattice import rebuilt
from flexsurr.config.aerodynamics import PanelCounts
from flexsurr.config.study import Integrator
from flexsurr.flight import equations_of_motion as states
from flexsurr.flight.airliner import flexible_airframe
from flexsurr.flight.linear_aerodynamics import derivatives, linear_aerodynamics
from flexsurr.flight.model import TO_BODY, Doublet, FlightModel, features
from flexsurr.simulation import simulate

RK4 = Integrator(method="rk4", step_s=0.005)
D = 28


def level(speed: float = 200.0, altitude: float = 9000.0) -> np.ndarray:
    x = np.zeros(D)
    x[2], x[6] = altitude, speed
    return x


def airless(gnba_modes, **changes) -> FlightModel:
    nothing = linear_aerodynamics(np.zeros(25), np.zeros(12), np.zeros((12, 25)))
    return dataclasses.replace(FlightModel(gnba_modes, nothing), **changes)


def undamped(gnba_modes):
    model = gnba_modes.model
    aircraft = model.aircraft.model_copy(update={"structural_damping_ratio": 0.0})
    return dataclasses.replace(gnba_modes, model=dataclasses.replace(model, aircraft=aircraft))


def earth_axes(x: np.ndarray) -> np.ndarray:
    """Rotation from body axes to north, east, down."""
    phi, theta, psi = x[3:6]
    c, s = np.cos, np.sin
    roll = np.array([[1, 0, 0], [0, c(phi), -s(phi)], [0, s(phi), c(phi)]])
    pitch = np.array([[c(theta), 0, s(theta)], [0, 1, 0], [-s(theta), 0, c(theta)]])
    yaw = np.array([[c(psi), -s(psi), 0], [s(psi), c(psi), 0], [0, 0, 1]])
    return yaw @ pitch @ roll


STATES = st.tuples(
    st.tuples(*[st.floats(-0.8, 0.8)] * 3),
    st.tuples(st.floats(50.0, 200.0), st.floats(-30.0, 30.0), st.floats(-30.0, 30.0)),
    st.tuples(*[st.floats(-0.5, 0.5)] * 3),
    st.tuples(*[st.floats(-50.0, 50.0)] * 16),
)


@settings(max_examples=15)
@given(STATES)
def test_without_air_energy_and_momentum_are_kept(gnba_modes, state):
    attitude, velocity, rates, elastic = state
    x0 = np.concatenate([[0.0, 0.0, 9000.0], attitude, velocity, rates, elastic])
    model = airless(undamped(gnba_modes))
    run = simulate(model, np.linspace(0.0, 0.5, 11), x0, RK4)
    assert run.completed
    energy = model.energy(run.x)
    kinetic = 0.5 * model.modes.properties.mass * velocity[0] ** 2
    assert np.ptp(energy) < 1e-4 * kinetic
    inertia = TO_BODY @ model.modes.properties.inertia @ TO_BODY
    angular = np.array([earth_axes(x) @ inertia @ x[9:12] for x in run.x])
    assert np.abs(angular - angular[0]).max() < 1e-6 * max(np.linalg.norm(angular[0]), 1e3)
    speed = np.array([earth_axes(x) @ x[6:9] for x in run.x])
    fall = 9.80665 * run.t
    assert speed - speed[0] == pytest.approx(np.stack([0 * fall, 0 * fall, fall], axis=1), abs=1e-6)
    ground = x0[:3] + run.t[:, None] * speed[0] * [1, 1, -1] - np.outer(0.5 * 9.80665 * run.t**2, [0, 0, 1])
    assert run.x[:, :3] == pytest.approx(ground, abs=1e-6)


def test_each_mode_rings_down_as_a_damped_oscillator(gnba_modes):
    model = airless(gnba_modes)
    x0 = level()
    x0[12:20] = np.arange(1.0, 9.0)
    t = np.linspace(0.0, 1.0, 201)
    run = simulate(model, t, x0, Integrator(method="rk4", step_s=0.0025))
    omega, zeta = gnba_modes.omega_rad_s, 0.02
    damped = omega * np.sqrt(1.0 - zeta**2)
    envelope = np.exp(-zeta * np.outer(t, omega))
    phase = np.outer(t, damped)
    exact = x0[12:20] * envelope * (np.cos(phase) + zeta / np.sqrt(1.0 - zeta**2) * np.sin(phase))
    assert run.x[:, 12:20] == pytest.approx(exact, abs=2e-3)


def test_coefficients_act_as_forces_moments_and_generalised_forces(gnba_modes):
    value = np.arange(1.0, 13.0) * 1e-3
    model = FlightModel(gnba_modes, linear_aerodynamics(np.zeros(25), value, np.zeros((12, 25))))
    x = level()
    x[6], x[8] = 200.0 * np.cos(0.1), 200.0 * np.sin(0.1)
    dx = model.derivative(0.0, x)
    pressure = 0.5 * density(9000.0) * 200.0**2 * 116.0
    lift, drag, side, pitch, roll, yaw = value[:6]
    # lift is square to the airspeed and upwards, drag against it
    force = np.array(
        [
            lift * np.sin(0.1) - drag * np.cos(0.1),
            side,
            -lift * np.cos(0.1) - drag * np.sin(0.1),
        ]
    )
    assert dx[6:9] == pytest.approx(pressure * force / 55764.0 + [0.0, 0.0, 9.80665])
    inertia = TO_BODY @ gnba_modes.properties.inertia @ TO_BODY
    moment = pressure * np.array([roll, pitch, yaw]) * [32.756, 3.862, 32.756]
    assert inertia @ dx[9:12] == pytest.approx(moment)
    generalised = np.zeros(8)
    generalised[[0, 1, 4, 5, 6, 7]] = pressure * value[6:]
    assert dx[20:] == pytest.approx(generalised)


def test_thrust_pulls_forward_below_the_centre_of_gravity(gnba_modes):
    x = level()
    pulled = airless(gnba_modes, thrust_N=5e4).derivative(0.0, x) - airless(gnba_modes).derivative(0.0, x)
    assert pulled[6] == pytest.approx(5e4 / 55764.0)
    assert pulled[10] > 0.0  # nose up
    nodes, (right, left) = gnba_modes.model.skeleton.nodes, gnba_modes.model.engines
    height = gnba_modes.properties.centre_of_gravity[2] - nodes[right, 2]
    assert pulled[10] == pytest.approx(5e4 * height / gnba_modes.properties.inertia[1, 1])
    forward = -gnba_modes.shapes.reshape(-1, 6, 8)[[right, left], 0]
    assert pulled[20:] == pytest.approx(2.5e4 * forward.sum(axis=0))


def test_features_in_the_equations_are_those_along_a_trajectory(gnba_modes):
    """Coefficients that pick one feature each tell what the compiled equations pass on."""
    rng = np.random.default_rng(1)
    x = level()
    x[3:12] += rng.normal(size=9) * [0.1, 0.1, 0.1, 5.0, 5.0, 5.0, 0.1, 0.1, 0.1]
    x[12:] = rng.normal(size=16) * 20.0
    doublet = Doublet(np.array([0.0, 0.01, 0.02, 0.03, -0.03, 0.04]), (0.5, 1.5, 2.5))
    for first in (0, 12, 13):
        slopes = np.zeros((12, 25))
        slopes[range(12), first + np.arange(12)] = 1.0
        model = FlightModel(
            gnba_modes,
            linear_aerodynamics(np.zeros(25), np.zeros(12), slopes),
            controls=(0.1, 0.2, 0.3, 0.4, 0.5, 0.6),
            doublet=doublet,
            gravity_m_s2=0.0,
        )
        rest = dataclasses.replace(
            model, aerodynamics=linear_aerodynamics(np.zeros(25), np.zeros(12), 0 * slopes)
        )
        speed = np.linalg.norm(x[6:9])
        pressure = 0.5 * density(x[2]) * speed**2 * 116.0
        for t in (0.2, 1.0, 2.0):
            added = model.derivative(t, x) - rest.derivative(t, x)
            inputs = features(model, np.array([t]), x[None])[0, first : first + 12]
            sine, cosine = x[8] / np.hypot(x[6], x[8]), x[6] / np.hypot(x[6], x[8])
            lift, drag, side = inputs[:3]
            force = np.array([sine * lift - cosine * drag, side, -cosine * lift - sine * drag])
            assert added[6:9] == pytest.approx(pressure * force / 55764.0, rel=1e-9, abs=1e-9)
            assert added[[20, 21, 24, 25, 26, 27]] == pytest.approx(pressure * inputs[6:], rel=1e-9, abs=1e-6)
    u, v, w = x[6:9]
    by_hand = [speed / speed_of_sound(x[2]), x[2], np.arctan(w / u), np.arcsin(v / speed), *x[9:12] / speed]
    assert features(model, np.array([1.0]), x[None])[0, :7] == pytest.approx(by_hand)
    etas = x[[12, 13, 16, 17, 18, 19]]
    rates = x[[20, 21, 24, 25, 26, 27]] / speed
    assert features(model, np.array([1.0]), x[None])[0, 13:] == pytest.approx(np.concatenate([etas, rates]))


def test_the_lattice_rebuilt_at_every_call_can_be_flown(gnba_modes):
    coarse = PanelCounts(wing=(10, 2), horizontal_tail=(4, 2), vertical_tail=(4, 2))
    model = FlightModel(gnba_modes, rebuilt(flexible_airframe(gnba_modes, coarse)))
    x = level()
    x[8:12] = 12.0, 0.01, 0.02, -0.01
    x[12:] = np.linspace(-3.0, 3.0, 16)
    coefficients = model.aerodynamics(features(model, np.zeros(1), x[None]))[0]
    held = linear_aerodynamics(np.zeros(25), coefficients, np.zeros((12, 25)))
    same = model.with_aerodynamics(held).derivative(0.0, x)
    assert model.derivative(0.0, x) == pytest.approx(same, rel=1e-9, abs=1e-9)
    assert coefficients[LIFT] > 0.2


def test_a_doublet_goes_up_comes_down_and_ends(gnba_modes):
    doublet = Doublet(np.full(CONTROLS, 0.1), (0.5, 1.5, 2.5))
    model = airless(gnba_modes, doublet=doublet)
    assert model.breakpoints == (0.5, 1.5, 2.5)
    t = np.array([0.0, 0.5, 1.49, 1.5, 2.49, 2.5, 4.0])
    found = features(model, t, np.tile(level(), (7, 1)))[:, 7:13]
    assert found == pytest.approx(np.outer([0.0, 0.1, 0.1, -0.1, -0.1, 0.0, 0.0], np.ones(6)))


def test_derivatives_of_a_linear_aerodynamics_are_its_own():
    rng = np.random.default_rng(0)
    slopes = rng.normal(size=(len(COEFFICIENTS), len(FEATURES)))
    about = np.concatenate([[0.7, 1e4], rng.normal(size=23) * 0.1])
    mapped = linear_aerodynamics(about, rng.normal(size=12), slopes)
    assert derivatives(mapped, about) == pytest.approx(slopes, abs=1e-5)


def test_modes_that_are_not_there_are_refused(gnba_modes):
    with pytest.raises(ValueError, match="modes 1 to 8"):
        airless(gnba_modes, chosen=(1, 9))
    with pytest.raises(ValueError, match="slopes"):
        linear_aerodynamics(np.zeros(25), np.zeros(12), np.zeros((12, 24)))


def test_every_state_is_found_by_its_name_where_it_stands():
    for place, name in enumerate(states.state_names(2)[: states.RIGID_STATES]):
        assert getattr(states, name.upper()) == place
    assert states.state_names(2)[states.RIGID_STATES :] == ("eta_1", "eta_2", "eta_dot_1", "eta_dot_2")
    assert states.state_names(0)[states.VELOCITY_IN_X] == states.VELOCITY
    assert states.state_names(0)[states.RATES_IN_X] == states.RATES
