"""The even Hamiltonian network: derivatives of its residuals, and what it learns."""

from dataclasses import replace

import numpy as np
import pytest
from oscillator import free_responses, three_pairs

from flexsurr.config.trial import trial_of
from flexsurr.surrogates import PolynomialHamiltonian, canonical_scaling, load, save
from flexsurr.training import fit, nmse
from flexsurr.training.even_hnn_training import EvenHNNObjective, untrained_even_hnn


@pytest.mark.parametrize("dataset", [free_responses(4, 10), three_pairs()], ids=["one pair", "three"])
def test_normal_equations(dataset, monkeypatch):
    """Against differences of the residuals, in pieces smaller than the samples."""
    monkeypatch.setattr("flexsurr.training.even_hnn_training.CHUNK", 2000)
    network = untrained_even_hnn(dataset, (4,), "softplus", 1)
    objective = EvenHNNObjective.of(network, dataset.x_train, dataset.dx_train)

    def residuals(parameters):
        field = replace(network, parameters=parameters).derivative(0.0, dataset.x_train)
        weights = 1.0 / dataset.dx_train.var(axis=0) / dataset.dx_train.size
        return ((field - dataset.dx_train) * np.sqrt(weights)).ravel()

    h = 1e-5
    columns = [
        (residuals(network.parameters + h * e) - residuals(network.parameters - h * e)) / (2 * h)
        for e in np.eye(network.parameter_count)
    ]
    jacobian, r = np.stack(columns, axis=1), residuals(network.parameters)
    equations = objective.normal_equations(network.parameters)
    assert equations.loss == pytest.approx(r @ r, rel=1e-12)
    assert equations.loss == pytest.approx(objective.loss(network.parameters), rel=1e-12)
    np.testing.assert_allclose(equations.gradient, jacobian.T @ r, rtol=1e-6, atol=1e-8 * np.abs(r).max())
    gradient = np.empty_like(network.parameters)
    assert objective.gradient(network.parameters, gradient) == pytest.approx(equations.loss, rel=1e-12)
    np.testing.assert_allclose(
        0.5 * gradient, equations.gradient, rtol=1e-9, atol=1e-12 * np.abs(gradient).max()
    )
    step = 1e-2 * np.random.default_rng(2).normal(size=network.parameter_count)
    second = residuals(network.parameters + step) - 2.0 * r + residuals(network.parameters - step)
    found = objective.bend(network.parameters, step)
    np.testing.assert_allclose(found, jacobian.T @ second, atol=1e-2 * np.abs(found).max())
    gram = jacobian.T @ jacobian
    np.testing.assert_allclose(equations.gram, gram, rtol=1e-5, atol=1e-7 * np.abs(gram).max())


def test_few_neurons_learn_a_symmetric_oscillator(tmp_path):
    dataset = free_responses()
    trial = trial_of(architecture="even_hnn", hidden=(4,), activation="half_log", epochs=120)
    found = fit(trial, dataset, tmp_path)
    assert found.validation_nmse < 1e-7
    assert found.validation_nmse == pytest.approx(
        nmse(found.surrogate.derivative(0.0, dataset.x_validation), dataset.dx_validation), rel=1e-6
    )
    save(found.surrogate, tmp_path / "weights.npz")
    x = dataset.x_validation
    np.testing.assert_array_equal(
        load(tmp_path / "weights.npz").derivative(0.0, x), found.surrogate.derivative(0.0, x)
    )


@pytest.mark.parametrize("seed", range(3))
def test_four_cubes_learn_a_polynomial_of_degree_six(seed, tmp_path):
    """A cubic in q² and p², but for special ones, is a sum of four cubes of linear functions of them."""
    exponents = np.array([(2 * i, 2 * j) for i in range(4) for j in range(4 - i) if i + j > 0])
    coefficients = np.random.default_rng(seed).uniform(0.2, 1.0, len(exponents)) / exponents.sum(axis=1) ** 2
    responses = free_responses()
    energy = PolynomialHamiltonian(
        coefficients,
        canonical_scaling(responses.scales),
        responses.state_names,
        responses.state_units,
        exponents=exponents,
    )
    dataset = replace(
        responses,
        dx_train=energy.derivative(0.0, responses.x_train),
        dx_validation=energy.derivative(0.0, responses.x_validation),
    )
    trial = trial_of(architecture="even_hnn", hidden=(4,), activation="cube", epochs=400, seed=seed)
    assert fit(trial, dataset, tmp_path).validation_nmse < 1e-12


def test_what_it_does_not_take_is_refused():
    with pytest.raises(ValueError, match="lbfgs"):
        trial_of(architecture="even_hnn", hidden=(4,), activation="atan", optimiser="lbfgs")
    with pytest.raises(ValueError, match="scaling does nothing"):
        trial_of(architecture="even_hnn", hidden=(4,), activation="atan", scaling="per_feature")
