"""Every method converges at its order."""

from itertools import pairwise

import numpy as np
import pytest

from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate
from flexsurr.simulation.adaptive_explicit import _interpolate
from flexsurr.simulation.closed_form_problems import (
    FORCED,
    OSCILLATOR,
    PULSED,
    Planar,
    forced_solution,
    planar,
    pulsed_solution,
)
from flexsurr.simulation.rhs import evaluate
from flexsurr.simulation.unrolled import dop853_dense, dop853_step

FIXED = [
    ("rk4", 4, [0.02, 0.01, 0.005, 0.0025]),
    ("dop853_fixed", 8, [0.4, 0.25, 0.2, 0.125]),
    ("gauss_legendre_4", 4, [0.04, 0.02, 0.01, 0.005]),
    ("gauss_legendre_6", 6, [0.1, 0.0625, 0.05, 0.025]),
]
ADAPTIVE = ["dop853", "radau_iia_5"]


def observed_order(steps, errors):
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize(("method", "order", "steps"), FIXED)
def test_order_on_a_forced_oscillator(method, order, steps):
    t = np.array([0.0, 3.0])
    errors = []
    for h in steps:
        end = simulate(planar(FORCED, 3.0, 2.0), t, np.zeros(2), Integrator(method=method, step_s=h)).x[-1, 0]
        errors.append(abs(end - forced_solution(3.0, 3.0, 2.0)))
    assert observed_order(steps, errors) == pytest.approx(order, abs=0.35)


@pytest.mark.parametrize(("method", "order", "steps"), FIXED)
def test_a_force_that_stops_between_samples_keeps_the_order(method, order, steps):
    stop = 1.2345678
    model = planar(PULSED, 3.0, stop, breakpoints=(stop,))
    errors = []
    for h in steps:
        end = simulate(model, np.array([0.0, 3.0]), np.zeros(2), Integrator(method=method, step_s=h)).x[-1, 0]
        errors.append(abs(end - pulsed_solution(3.0, 3.0, stop)))
    assert observed_order(steps, errors) == pytest.approx(order, abs=0.5)


def test_without_the_breakpoint_the_order_is_lost():
    """The test above can fail."""
    stop = 1.2345678
    errors = []
    for h in (0.2, 0.1, 0.05):
        trajectory = simulate(
            planar(PULSED, 3.0, stop),
            np.array([0.0, 3.0]),
            np.zeros(2),
            Integrator(method="dop853_fixed", step_s=h),
        )
        errors.append(abs(trajectory.x[-1, 0] - pulsed_solution(3.0, 3.0, stop)))
    assert min(errors) > 1e-6


@pytest.mark.parametrize("method", ADAPTIVE)
def test_error_is_proportional_to_the_tolerance(method):
    tolerances = np.array([1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9])
    t = np.linspace(0.0, 10.0, 101)
    errors = []
    for tolerance in tolerances:
        integrator = Integrator(method=method, rtol=tolerance, atol=tolerance)
        x = simulate(planar(OSCILLATOR, 2.0), t, np.array([1.0, 0.0]), integrator).x
        errors.append(np.abs(x[:, 0] - np.cos(2 * t)).max())
    assert observed_order(tolerances, errors) == pytest.approx(1.0, abs=0.25)
    assert all(fine < coarse for coarse, fine in pairwise(errors))
    assert errors[-1] < 300 * tolerances[-1]


def test_dense_output_of_dop853_has_order_7():
    kernel, work = Planar(OSCILLATOR, 1.0), np.empty(0)
    steps, errors = [0.8, 0.6, 0.4, 0.3], []
    for h in steps:
        x, new, y, sample = np.array([1.0, 0.0]), np.empty(2), np.empty(2), np.empty(2)
        k, dense = np.empty((16, 2)), np.empty((7, 2))
        evaluate(kernel, 0.0, x, k[0], work)
        dop853_step(kernel, 0.0, h, x, new, k, y, work, (0, 0))
        evaluate(kernel, h, new, k[12], work)
        dop853_dense(kernel, 0.0, h, x, new, dense, k, y, work, (0, 0))
        worst = 0.0
        for theta in np.linspace(0.0, 1.0, 21):
            _interpolate(theta, x, dense, sample)
            exact = np.array([np.cos(theta * h), -np.sin(theta * h)])
            worst = max(worst, np.abs(sample - exact).max())
        errors.append(worst)
    assert observed_order(steps, errors) == pytest.approx(8.0, abs=0.3)  # of one step: one more than globally


@pytest.mark.parametrize("method", ADAPTIVE)
def test_samples_do_not_limit_the_step(method):
    integrator = Integrator(method=method, rtol=1e-8, atol=1e-8)
    runs = [
        simulate(planar(FORCED, 3.0, 2.0), np.linspace(0.0, 5.0, m), np.zeros(2), integrator)
        for m in (2, 5001)
    ]
    assert runs[0].steps == runs[1].steps < 500
    assert np.array_equal(runs[0].x[-1], runs[1].x[-1])
    error = np.abs(runs[1].x[:, 0] - forced_solution(runs[1].t, 3.0, 2.0)).max()
    assert error < 1e-6


@pytest.mark.parametrize("method", ADAPTIVE)
def test_adaptive_methods_start_anew_at_a_breakpoint(method):
    stop = 1.2345678
    t = np.linspace(0.0, 3.0, 301)
    integrator = Integrator(method=method, rtol=1e-9, atol=1e-11)
    trajectory = simulate(planar(PULSED, 3.0, stop, (stop,)), t, np.zeros(2), integrator)
    assert np.abs(trajectory.x[:, 0] - pulsed_solution(t, 3.0, stop)).max() < 1e-7
