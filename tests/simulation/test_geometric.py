"""Gauss–Legendre methods keep what a Hamiltonian flow keeps."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate
from flexsurr.simulation.closed_form_problems import (
    OSCILLATOR,
    PENDULUM,
    KernelModel,
    PendulumVariation,
    planar,
)

METHODS = ["gauss_legendre_4", "gauss_legendre_6"]
J = np.array([[0.0, 1.0], [-1.0, 0.0]])


def pendulum_energy(x):
    return 0.5 * x[..., 1] ** 2 - np.cos(x[..., 0])


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=20, deadline=None)
@given(q=st.floats(-2.5, 2.5), p=st.floats(-1.5, 1.5), h=st.floats(0.01, 0.3))
def test_the_flow_is_symplectic(method, q, p, h):
    start = np.array([q, p, 1.0, 0.0, 0.0, 1.0])
    end = simulate(
        KernelModel(PendulumVariation(), 6),
        np.array([0.0, 3.0]),
        start,
        Integrator(method=method, step_s=h),
    ).x[-1]
    flow = end[2:].reshape(2, 2)
    assert flow.T @ J @ flow == pytest.approx(J, abs=2e-13 * max(1.0, np.abs(flow).max() ** 2))


def test_the_classical_method_is_not_symplectic():
    """The test above can fail."""
    end = simulate(
        KernelModel(PendulumVariation(), 6),
        np.array([0.0, 3.0]),
        np.array([1.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
        Integrator(method="rk4", step_s=0.1),
    ).x[-1]
    flow = end[2:].reshape(2, 2)
    assert np.abs(flow.T @ J @ flow - J).max() > 1e-8


@pytest.mark.parametrize(("method", "bound"), [("gauss_legendre_4", 2e-5), ("gauss_legendre_6", 2e-8)])
def test_energy_stays_bounded_and_does_not_drift(method, bound):
    t = np.linspace(0.0, 20_000.0, 20_001)
    x = simulate(planar(PENDULUM), t, np.array([1.5, 0.0]), Integrator(method=method, step_s=0.1)).x
    error = pendulum_energy(x) - pendulum_energy(x[0])
    assert np.abs(error).max() < bound
    assert abs(error[:2000].mean() - error[-2000:].mean()) < 1e-12 + 1e-2 * bound


@pytest.mark.parametrize("method", METHODS)
def test_a_quadratic_invariant_is_kept_to_rounding(method):
    t = np.linspace(0.0, 1000.0, 101)
    x = simulate(planar(OSCILLATOR, 2.0), t, np.array([1.0, 0.0]), Integrator(method=method, step_s=0.05)).x
    energy = 4.0 * x[:, 0] ** 2 + x[:, 1] ** 2
    assert np.abs(energy / 4.0 - 1.0).max() < 5e-13


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=20, deadline=None)
@given(q=st.floats(-2.5, 2.5), p=st.floats(-1.5, 1.5))
def test_time_reversal_leads_back(method, q, p):
    integrator = Integrator(method=method, step_s=0.05)
    t = np.array([0.0, 5.0])
    there = simulate(planar(PENDULUM), t, np.array([q, p]), integrator).x[-1]
    back = simulate(planar(PENDULUM), t, there * [1, -1], integrator).x[-1]
    assert back * [1, -1] == pytest.approx([q, p], abs=1e-11)


def test_a_step_that_is_too_long_is_reported():
    trajectory = simulate(
        planar(OSCILLATOR, 1e4),
        np.array([0.0, 1.0]),
        np.array([1.0, 0.0]),
        Integrator(method="gauss_legendre_6", step_s=0.1),
    )
    assert not trajectory.completed
    assert "did not converge" in trajectory.reason
    assert len(trajectory.t) == 1
