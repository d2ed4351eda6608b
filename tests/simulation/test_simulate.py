"""What `simulate` promises, whatever the method."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexsurr.config.study import Integrator
from flexsurr.simulation import CompiledModel, Model, simulate
from flexsurr.simulation.closed_form_problems import (
    BLOW_UP,
    BREAKS_OFF,
    FORCED,
    OSCILLATOR,
    PULSED,
    PythonModel,
    forced_solution,
    planar,
    pulsed_solution,
)

COMPILED = [
    Integrator(method="rk4", step_s=1e-3),
    Integrator(method="dop853_fixed", step_s=1e-2),
    Integrator(method="gauss_legendre_4", step_s=2e-3),
    Integrator(method="gauss_legendre_6", step_s=1e-2),
    Integrator(method="dop853", rtol=1e-8, atol=1e-10),
    Integrator(method="radau_iia_5", rtol=1e-8, atol=1e-10),
]
SCIPY = [
    Integrator(method=f"scipy_{name}", rtol=1e-8, atol=1e-10)
    for name in ("radau", "bdf", "lsoda", "rk45", "dop853")
]
ALL = pytest.mark.parametrize("integrator", COMPILED + SCIPY, ids=lambda i: i.method)
T = np.linspace(0.0, 2.0, 41)


@ALL
def test_methods_agree_on_a_closed_form(integrator):
    trajectory = simulate(planar(FORCED, 3.0, 2.0), T, np.zeros(2), integrator)
    assert trajectory.completed
    assert trajectory.reason == ""
    assert trajectory.end_time_s == T[-1]
    assert np.array_equal(trajectory.t, T)
    assert trajectory.evaluations >= trajectory.steps > 0
    assert trajectory.state_names == ("x_0", "x_1")
    assert np.abs(trajectory.x[:, 0] - forced_solution(T, 3.0, 2.0)).max() < 1e-5


@ALL
@settings(max_examples=8, deadline=None)
@given(stop=st.floats(0.01, 1.99))
def test_a_force_may_stop_at_any_time(integrator, stop):
    trajectory = simulate(planar(PULSED, 3.0, stop, (stop,)), T, np.zeros(2), integrator)
    assert trajectory.completed
    assert len(trajectory.t) == len(T)
    assert np.abs(trajectory.x[:, 0] - pulsed_solution(T, 3.0, stop)).max() < 1e-5


@pytest.mark.parametrize("stop", [-1.0, 0.0, 0.05, 1.0, 2.0, 3.0])
def test_breakpoints_may_fall_on_samples_or_outside(stop):
    model = planar(PULSED, 3.0, stop, (stop, stop, stop + 1e-15))
    trajectory = simulate(model, T, np.zeros(2), COMPILED[1])
    expected = pulsed_solution(T, 3.0, stop) if stop > 0 else 0.0
    assert np.abs(trajectory.x[:, 0] - expected).max() < 1e-12


@ALL
def test_blow_up_in_finite_time_ends_the_trajectory(integrator):
    """ẋ = x² from 1 is 1/(1 − t)."""
    trajectory = simulate(planar(BLOW_UP), T, np.array([1.0, 0.0]), integrator)
    assert not trajectory.completed
    assert trajectory.reason
    assert trajectory.end_time_s == pytest.approx(1.0, abs=0.15)
    assert np.isfinite(trajectory.x).all()
    assert len(trajectory.t) == len(trajectory.x) < len(T)
    before = trajectory.t < 0.9
    assert trajectory.x[before, 0] == pytest.approx(1.0 / (1.0 - trajectory.t[before]), rel=1e-4)


# SciPy's multistep solvers give up at the first NaN instead of shortening the step that met it.
SHORTENING = pytest.mark.parametrize(
    "integrator",
    [i for i in COMPILED + SCIPY if i.method not in ("scipy_bdf", "scipy_lsoda")],
    ids=lambda i: i.method,
)


@pytest.mark.parametrize("method", ["scipy_bdf", "scipy_lsoda"])
def test_multistep_solvers_that_meet_nan_give_up(method):
    trajectory = simulate(planar(BREAKS_OFF, b=1.23), T, np.zeros(2), Integrator(method=method))
    assert not trajectory.completed
    assert trajectory.reason
    assert trajectory.end_time_s < 1.23
    assert trajectory.x[:, 0] == pytest.approx(trajectory.t, abs=1e-9)


@SHORTENING
def test_equations_that_break_off_end_the_trajectory(integrator):
    trajectory = simulate(planar(BREAKS_OFF, b=1.23), T, np.zeros(2), integrator)
    assert not trajectory.completed
    assert trajectory.reason
    assert trajectory.end_time_s == pytest.approx(1.23, abs=0.05)
    assert len(trajectory.t) == np.searchsorted(T, trajectory.end_time_s, side="right")
    assert trajectory.x[:, 0] == pytest.approx(trajectory.t, abs=1e-9)


@ALL
def test_equations_that_never_hold_are_reported(integrator):
    trajectory = simulate(planar(BREAKS_OFF, b=-1.0), T, np.zeros(2), integrator)
    assert not trajectory.completed
    assert len(trajectory.t) == 1
    assert "finite" in trajectory.reason


@pytest.mark.parametrize("integrator", SCIPY, ids=lambda i: i.method)
def test_an_exception_of_the_model_is_the_reason(integrator):
    def equilibrium_lost(t, x):
        if t > 1.0:
            raise ArithmeticError("no equilibrium at this load")
        return -x

    trajectory = simulate(PythonModel(equilibrium_lost), T, np.ones(1), integrator)
    assert not trajectory.completed
    assert "ArithmeticError: no equilibrium at this load" in trajectory.reason
    assert 0.5 < trajectory.end_time_s <= 1.0
    assert trajectory.x[:, 0] == pytest.approx(np.exp(-trajectory.t), abs=1e-6)


@SHORTENING
def test_a_failure_after_a_breakpoint_keeps_what_came_before(integrator):
    trajectory = simulate(planar(BREAKS_OFF, b=1.23, breakpoints=(0.777,)), T, np.zeros(2), integrator)
    assert not trajectory.completed
    assert trajectory.end_time_s == pytest.approx(1.23, abs=0.05)
    assert trajectory.x[:, 0] == pytest.approx(trajectory.t, abs=1e-9)


@ALL
def test_one_sample_is_the_initial_state(integrator):
    trajectory = simulate(planar(OSCILLATOR, 1.0), np.array([0.5]), np.array([1.0, 2.0]), integrator)
    assert trajectory.completed
    assert trajectory.x.tolist() == [[1.0, 2.0]]


@ALL
def test_the_initial_state_is_not_touched(integrator):
    x0 = np.array([1.0, 0.0])
    simulate(planar(OSCILLATOR, 1.0), T, x0, integrator)
    assert x0.tolist() == [1.0, 0.0]


@pytest.mark.parametrize(("h", "steps"), [(0.05, 40), (0.0499, 80), (0.02, 120), (1.0, 40)])
def test_the_step_is_an_upper_bound(h, steps):
    trajectory = simulate(planar(OSCILLATOR, 1.0), T, np.zeros(2), Integrator(method="rk4", step_s=h))
    assert trajectory.steps == steps
    assert trajectory.evaluations == 4 * steps


def test_counts_are_scipys_own():
    ours = simulate(planar(OSCILLATOR, 5.0), T, np.array([1.0, 0.0]), Integrator(method="dop853", rtol=1e-6))
    theirs = simulate(
        planar(OSCILLATOR, 5.0), T, np.array([1.0, 0.0]), Integrator(method="scipy_dop853", rtol=1e-6)
    )
    assert ours.steps == pytest.approx(theirs.steps, abs=2)
    assert ours.x == pytest.approx(theirs.x, abs=1e-4)


def test_a_compiled_method_wants_a_kernel():
    with pytest.raises(TypeError, match="rk4 steps compiled models; PythonModel has no kernel"):
        simulate(PythonModel(lambda t, x: x), T, np.ones(1), COMPILED[0])


@pytest.mark.parametrize(
    ("t", "x0", "message"),
    [
        ([], [0.0, 0.0], "t must"),
        ([0.0, 0.0], [0.0, 0.0], "t must"),
        ([1.0, 0.0], [0.0, 0.0], "t must"),
        ([0.0, np.nan], [0.0, 0.0], "t must"),
        ([0.0, 1.0], [0.0], "x0 must hold 2 finite values, one for each of x_0, x_1"),
        ([0.0, 1.0], [0.0, np.inf], "x0 must"),
    ],
)
def test_wrong_arguments_are_refused(t, x0, message):
    with pytest.raises(ValueError, match=message):
        simulate(planar(OSCILLATOR, 1.0), np.array(t), np.array(x0), COMPILED[0])


def test_models_are_recognised():
    assert isinstance(planar(OSCILLATOR), CompiledModel)
    assert isinstance(PythonModel(lambda t, x: x), Model)
    assert not isinstance(PythonModel(lambda t, x: x), CompiledModel)
