"""Many trajectories in one call: those of single calls, whatever the threads and the others do."""

import numpy as np
import pytest

from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate, simulate_ensemble
from flexsurr.simulation.closed_form_problems import BLOW_UP, OSCILLATOR, PythonModel, planar
from flexsurr.simulation.python_kernel import PythonEquations, calls_python

OMEGA = 3.0
MODEL = planar(OSCILLATOR, OMEGA)
T = np.linspace(0.0, 1.0, 6)
STARTS = np.random.default_rng(0).normal(size=(150, 2))
ADAPTIVE = Integrator(method="dop853", rtol=1e-8, atol=1e-10)
FIXED = Integrator(method="rk4", step_s=0.01)


def test_each_is_the_trajectory_of_a_single_call():
    found = simulate_ensemble(MODEL, T, STARTS, ADAPTIVE)
    each = [simulate(MODEL, T, start, ADAPTIVE) for start in STARTS]
    np.testing.assert_array_equal(found.kept, [one.x for one in each])
    assert found.completed.all()
    assert found.evaluations == sum(one.evaluations for one in each)
    exact = STARTS[:, :1] * np.cos(OMEGA * T) + STARTS[:, 1:] / OMEGA * np.sin(OMEGA * T)
    np.testing.assert_allclose(found.kept[..., 0], exact, atol=1e-6)


@pytest.mark.parametrize("threads", [2, 3, None])
def test_threads_change_no_bit(threads):
    one = simulate_ensemble(MODEL, T, STARTS, ADAPTIVE, threads=1)
    np.testing.assert_array_equal(
        simulate_ensemble(MODEL, T, STARTS, ADAPTIVE, threads=threads).kept, one.kept
    )


def test_what_is_observed_is_all_that_is_kept():
    numbers = []

    def largest(block, x):
        numbers.extend(range(block.start, block.stop))
        assert len(x) <= 64
        return np.abs(x[..., 0]).max(axis=1)

    found = simulate_ensemble(MODEL, T, STARTS, ADAPTIVE, observe=largest, threads=1)
    everything = simulate_ensemble(MODEL, T, STARTS, ADAPTIVE).kept
    np.testing.assert_array_equal(found.kept, np.abs(everything[..., 0]).max(axis=1))
    assert numbers == list(range(len(STARTS)))


def test_what_an_observer_raises_is_raised():
    def fail(block, x):
        if block.start:
            raise KeyError(block.start)
        return x

    with pytest.raises(KeyError, match="64"):
        simulate_ensemble(MODEL, T, STARTS, ADAPTIVE, observe=fail, threads=2)


def test_each_may_have_a_model_of_its_own():
    models = [planar(OSCILLATOR, 1.0 + k) for k in range(3)]
    found = simulate_ensemble(models, T, STARTS[:3], ADAPTIVE)
    for model, start, x in zip(models, STARTS, found.kept, strict=False):
        np.testing.assert_array_equal(x, simulate(model, T, start, ADAPTIVE).x)


def test_one_that_fails_ends_alone():
    """ẋ = x² from 1 leaves the finite numbers at 1 s, from −1 never."""
    x0 = np.array([[-1.0, 0.0], [1.25, 0.0], [-2.0, 0.0]])
    found = simulate_ensemble(planar(BLOW_UP), T, x0, FIXED)
    assert found.completed.tolist() == [True, False, True]
    assert [bool(reason) for reason in found.reasons] == [False, True, False]
    assert 0.75 < found.end_time_s[1] < 0.85
    assert np.isfinite(found.kept[1, :4]).all()
    assert np.isnan(found.kept[1, -1]).all()
    np.testing.assert_allclose(found.kept[[0, 2], -1, 0], [-1.0 / 2.0, -1.0 / 1.5], rtol=1e-6)


def test_python_has_one_thread():
    kernel = PythonEquations(2, lambda x: -x).kernel
    assert calls_python((0.0, (kernel, 1)))
    assert not calls_python(MODEL.kernel)
    model = PythonModel(lambda t, x: -x)
    found = simulate_ensemble(model, T, STARTS[:2, :1], Integrator(method="scipy_rk45"), threads=2)
    np.testing.assert_allclose(found.kept[:, -1, 0], STARTS[:2, 0] * np.exp(-1.0), rtol=1e-2)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"x0": np.zeros((3, 1))}, "x0 must hold 2 values a state, one for each of x_0, x_1"),
        ({"x0": np.zeros((0, 2))}, "one or more states"),
        ({"x0": np.array([[0.0, 1.0], [np.nan, 0.0]])}, "state number 1 is not"),
        ({"model": [MODEL]}, "1 models do not fit 2 states"),
        ({"threads": 0}, "threads: 0 is not allowed; allowed: 1 or more"),
        ({"t": np.array([0.0, 0.0])}, "increasing"),
    ],
)
def test_what_does_not_fit_is_said(values, message):
    given = {"model": MODEL, "t": T, "x0": np.ones((2, 2)), "integrator": FIXED}
    with pytest.raises(ValueError, match=message):
        simulate_ensemble(**{**given, **values})
