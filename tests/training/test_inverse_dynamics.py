"""Polynomial port-Hamiltonian surrogates by linear least squares of inverse dynamics."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oscillator import STIFFNESS, free_responses

from flexsurr.config.trial import trial_of
from flexsurr.surrogates import PairScaling, PolynomialPortHamiltonian
from flexsurr.surrogates.monomials import monomials_to_degree
from flexsurr.surrogates.packed import pack
from flexsurr.training import fit, nmse, split_dataset
from flexsurr.training.inverse_dynamics import channel_spread, fit_port_hamiltonian

R = 2
NAMES = tuple(f"{kind}_{k}" for kind in ("eta", "p") for k in range(R))


def truth_of(seed, degree=4, even=True, damped=True):
    """A random mechanical system of two coordinates with a polynomial mass matrix."""
    generator = np.random.default_rng(seed)
    exponents = np.concatenate([np.zeros((1, R), dtype=np.int64), monomials_to_degree(R, degree)])
    exponents = exponents[exponents.sum(axis=1) % 2 == 0] if even else exponents
    mass = 0.03 * generator.normal(size=(3, len(exponents)))
    mass[:, 0] += pack(np.array([[1.0, 0.0], [0.3, 0.8]]))
    springs = generator.normal(size=(R, R))
    dampers = np.array([0.3, -0.2, 0.5]) if damped else np.zeros(3)
    parameters = np.concatenate([mass.ravel(), pack(springs @ springs.T + np.eye(R)), dampers])
    scaling = PairScaling(q=(0.3, 2.0), action=1.5, energy=60.0)
    return PolynomialPortHamiltonian(parameters, scaling, NAMES, ("1",) * 4, exponents)


def sampled(truth, samples=400, seed=0):
    """Random states and the field there; a fifth of them validate."""
    x = np.random.default_rng(seed).uniform(-1.0, 1.0, (samples, 4)) * truth.scaling.states(4)
    return split_dataset(
        np.arange(samples) % 5,
        x,
        truth.derivative(0.0, x),
        validation=[0],
        state_names=NAMES,
        state_units=("1",) * 4,
    )


@given(seed=st.integers(0, 2**32 - 1), even=st.booleans())
@settings(max_examples=10)
def test_mass_springs_and_dampers_are_found_to_rounding(seed, even):
    truth = truth_of(seed, even=even)
    dataset = sampled(truth)
    found = fit_port_hamiltonian(dataset, 4)
    assert np.array_equal(found.exponents, truth.exponents)
    q = dataset.x_validation[:, :R]
    for name in ("stiffness", "damping"):
        expected = getattr(truth, name)
        np.testing.assert_allclose(getattr(found, name), expected, atol=1e-10 * np.max(np.abs(expected)))
    expected = truth.mass_matrix(q)
    np.testing.assert_allclose(
        found.mass_matrix(q), expected, rtol=1e-9, atol=1e-10 * np.max(np.abs(expected))
    )
    assert nmse(found.derivative(0.0, dataset.x_validation), dataset.dx_validation) < 1e-20


def test_odd_powers_are_left_out_where_there_are_none():
    assert not np.any(fit_port_hamiltonian(sampled(truth_of(0)), 4).exponents.sum(axis=1) % 2)
    assert np.any(fit_port_hamiltonian(sampled(truth_of(0, even=False)), 4).exponents.sum(axis=1) % 2)


def test_without_damping_none_is_found():
    found = fit_port_hamiltonian(sampled(truth_of(1, damped=False)), 4)
    assert np.max(np.abs(found.scaled_damping)) < 1e-12


def test_an_oscillators_trajectories():
    """M = 0.18 + 0.1 q², K = 555, no damping: exactly of this form, so found from a few responses."""
    dataset = free_responses(4, 30)
    found = fit_port_hamiltonian(dataset, 2)
    np.testing.assert_allclose(found.mass_matrix(np.array([0.3]))[0, 0], 0.18 + 0.1 * 0.3**2, rtol=1e-9)
    np.testing.assert_allclose(found.stiffness, [[STIFFNESS]], rtol=1e-9)
    assert found.damping[0, 0] < 1e-9
    assert nmse(found.derivative(0.0, dataset.x_validation), dataset.dx_validation) < 1e-18


def test_fed_in_pieces_it_is_the_same(monkeypatch):
    dataset = sampled(truth_of(2))
    expected = fit_port_hamiltonian(dataset, 4)
    monkeypatch.setattr("flexsurr.training.inverse_dynamics.CHUNK", 9_000)
    monkeypatch.setattr("flexsurr.training.dataset.PIECE", 30)
    found = fit_port_hamiltonian(dataset, 4)
    np.testing.assert_allclose(found.parameters, expected.parameters, atol=1e-11)


def test_a_mass_matrix_that_is_none_is_a_failure_with_a_reason(tmp_path):
    """A field whose momentum turns against its velocity: the best M is negative."""
    dataset = sampled(truth_of(4))
    turned = replace(dataset, dx_train=dataset.dx_train * [-1, -1, 1, 1])
    trial = trial_of(architecture="port_hamiltonian", degree=2, optimiser="least_squares")
    result = fit(trial, turned, tmp_path)
    assert result.status == "failed"
    assert "of degree 2 is not positive definite at q = (" in result.reason


def test_a_fit_says_how_well_each_state_is_met(tmp_path):
    dataset = sampled(truth_of(5))
    trial = trial_of(architecture="port_hamiltonian", degree=2, optimiser="least_squares")
    result = fit(trial, dataset, tmp_path)
    assert (result.status, result.epochs, result.parameters) == ("finished", 1, 3 * (4 + 2))
    assert len(result.validation_nmse_per_state) == 4
    assert result.validation_nmse == pytest.approx(np.mean(result.validation_nmse_per_state))
    error = result.surrogate.derivative(0.0, dataset.x_validation) - dataset.dx_validation
    expected = np.mean(error**2, axis=0) / np.var(dataset.dx_validation, axis=0)
    np.testing.assert_allclose(result.validation_nmse_per_state, expected)


def test_the_spread_is_that_of_the_scaled_momenta_and_forces():
    dataset, scaling = sampled(truth_of(6)), truth_of(6).scaling
    scaled = dataset.x_train / scaling.states(4), dataset.dx_train / scaling.rates(4)
    expected = np.concatenate([np.std(part[:, R:], axis=0) for part in scaled])
    np.testing.assert_allclose(channel_spread(scaling, dataset.scales), expected, rtol=1e-13)


def test_momenta_that_do_not_vary_are_refused():
    dataset = sampled(truth_of(6))
    still = replace(dataset, x_train=dataset.x_train * [1, 1, 1, 0])
    with pytest.raises(ValueError, match="must vary"):
        channel_spread(truth_of(6).scaling, still.scales)
