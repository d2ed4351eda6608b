"""Radau IIA on stiff problems."""

import numpy as np
import pytest

from flexsurr.config.study import Integrator
from flexsurr.simulation import evaluate, simulate
from flexsurr.simulation.closed_form_problems import (
    DECAY,
    PROTHERO_ROBINSON,
    VAN_DER_POL,
    KernelModel,
    Planar,
    VanDerPol,
    evaluate_jacobian,
    planar,
)


@pytest.mark.parametrize("stiffness", [1e1, 1e4, 1.8e7, 1e9])
@pytest.mark.parametrize("end", [0.1, 1.0, 10.0])
def test_prothero_robinson(stiffness, end):
    """ẋ = −λ (x − cos t) − sin t."""
    trajectory = simulate(
        planar(PROTHERO_ROBINSON, stiffness),
        np.array([0.0, end]),
        np.array([1.0, 0.0]),
        Integrator(method="radau_iia_5", rtol=1e-7, atol=1e-9),
    )
    assert trajectory.completed
    assert trajectory.x[-1, 0] == pytest.approx(np.cos(end), abs=2e-6)
    assert trajectory.steps < 400


@pytest.mark.parametrize("rate", [1e3, 1e7, 1.8e7, 1e10])
def test_a_fast_mode_is_damped_out(rate):
    """L-stability: the transient dies and the steps grow without bound."""
    t = np.array([0.0, 1e-3, 30.0])
    trajectory = simulate(planar(DECAY, rate), t, np.array([1.0, 0.0]), Integrator(method="radau_iia_5"))
    assert trajectory.completed
    assert abs(trajectory.x[1, 0] - np.exp(-rate * 1e-3)) < 1e-3
    assert abs(trajectory.x[2, 0]) < 1e-6
    assert trajectory.steps < 60


@pytest.mark.parametrize("mu", [1e1, 1e3, 1e6])
def test_van_der_pol_agrees_with_scipy(mu):
    t = np.linspace(0.0, 0.6 * mu, 21)
    x0 = np.array([2.0, 0.0])
    ours = simulate(planar(VAN_DER_POL, mu), t, x0, Integrator(method="radau_iia_5", rtol=1e-8, atol=1e-11))
    theirs = simulate(planar(VAN_DER_POL, mu), t, x0, Integrator(method="scipy_radau", rtol=1e-8, atol=1e-11))
    assert ours.completed
    assert ours.x[:, 0] == pytest.approx(theirs.x[:, 0], abs=2e-6)
    assert ours.steps < 2 * theirs.steps
    assert ours.evaluations < 3 * theirs.evaluations


def test_a_kernel_may_bring_its_jacobian():
    """Steps hardly change, evaluations lose those of the differences."""
    t = np.linspace(0.0, 60.0, 7)
    x0 = np.array([2.0, 0.0])
    integrator = Integrator(method="radau_iia_5", rtol=1e-6, atol=1e-9)
    differences = simulate(planar(VAN_DER_POL, 100.0), t, x0, integrator)
    analytic = simulate(KernelModel(VanDerPol(100.0), 2), t, x0, integrator)
    assert analytic.x[:, 0] == pytest.approx(differences.x[:, 0], abs=1e-4)
    assert analytic.steps == pytest.approx(differences.steps, abs=5)
    assert analytic.evaluations < differences.evaluations


def test_finite_differences_are_the_jacobian():
    x = np.array([0.7, -1.3])
    found, expected = np.empty((2, 2)), np.empty((2, 2))
    slope = np.empty(2)
    evaluate(Planar(VAN_DER_POL, 5.0), 0.0, x, slope, np.empty(0))
    assert evaluate_jacobian(Planar(VAN_DER_POL, 5.0), 0.0, x, slope, found, np.empty(0)) == 2
    assert evaluate_jacobian(VanDerPol(5.0), 0.0, x, slope, expected, np.empty(0)) == 0
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-6)
    assert x.tolist() == [0.7, -1.3]
