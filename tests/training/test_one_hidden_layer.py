"""The normal equations of one hidden layer against the Jacobian that they do without."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from flexsurr.training.levenberg_marquardt import LevenbergMarquardt
from flexsurr.training.one_hidden_layer import OneHiddenLayer


def problem(seed, samples, inputs, hidden, outputs, activation="tanh"):
    generator = np.random.default_rng(seed)
    x = generator.uniform(-1.0, 1.0, (samples, inputs))
    y = generator.uniform(-1.0, 1.0, (samples, outputs)) * generator.uniform(0.1, 3.0, outputs)
    count = (inputs + 1) * hidden + (hidden + 1) * outputs
    objective = OneHiddenLayer.of_map(x, y, hidden, activation)
    return objective, generator.standard_normal(count)


def dense(objective, parameters, hidden, activation):
    """Weighted residuals and their Jacobian by automatic differentiation of the same network in torch."""
    x, y = torch.tensor(objective.x), torch.tensor(objective.y)
    n, h, k = x.shape[1], hidden, y.shape[1]
    function = {"tanh": torch.tanh, "atan": torch.atan}[activation]
    roots = torch.tensor(np.sqrt(objective.output_weights / len(objective.x)))

    def residuals(p):
        weights, biases, weights_out, biases_out = torch.split(p, [n * h, h, h * k, k])
        hidden = function(x @ weights.reshape(n, h) + biases)
        return (roots * (hidden @ weights_out.reshape(h, k) + biases_out - y)).ravel()

    p = torch.tensor(parameters)
    jacobian = torch.autograd.functional.jacobian(residuals, p)
    return residuals(p).numpy(), jacobian.numpy()


PROBLEMS = given(
    seed=st.integers(0, 2**20),
    inputs=st.integers(1, 5),
    hidden=st.integers(1, 6),
    outputs=st.integers(1, 4),
    activation=st.sampled_from(["tanh", "atan"]),
)


@settings(max_examples=25)
@PROBLEMS
def test_they_are_the_squares_of_the_jacobian(seed, inputs, hidden, outputs, activation):
    objective, parameters = problem(seed, 20, inputs, hidden, outputs, activation)
    residuals, jacobian = dense(objective, parameters, hidden, activation)
    equations = objective.normal_equations(parameters)
    gram = jacobian.T @ jacobian
    np.testing.assert_allclose(equations.gram, gram, rtol=1e-9, atol=1e-12 * np.abs(gram).max())
    np.testing.assert_allclose(equations.gradient, jacobian.T @ residuals, rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(equations.diagonal, equations.gram.diagonal(), rtol=1e-12)
    assert equations.loss == pytest.approx(residuals @ residuals, rel=1e-12)
    assert objective.loss(parameters) == pytest.approx(equations.loss, rel=1e-12)


@settings(max_examples=25)
@PROBLEMS
def test_a_step_is_that_of_the_whole_matrix(seed, inputs, hidden, outputs, activation):
    """Though the outputs' weights are eliminated first, all of them by one small matrix."""
    objective, parameters = problem(seed, 20, inputs, hidden, outputs, activation)
    equations = objective.normal_equations(parameters)
    damping = 1e-3 * np.maximum(equations.diagonal, objective.normal_equations(1.5 * parameters).diagonal)
    whole = equations.gram + np.diag(damping)
    assert np.linalg.norm(
        whole @ equations.solver(damping)(equations.gradient) + equations.gradient
    ) <= 1e-10 * np.linalg.norm(equations.gradient)


def test_a_neuron_that_no_sample_reaches_stays_as_it_is():
    """Its slopes are zero, and so are its rows of the matrix."""
    objective, parameters = problem(4, 30, 2, 3, 2)
    parameters[6] = 1e3  # its bias: tanh is 1 at all samples
    equations = objective.normal_equations(parameters)
    step = equations.solver(1e-3 * equations.diagonal)(equations.gradient)
    assert np.all(np.isfinite(step))
    assert np.all(step[[0, 3, 6]] == 0.0)


def test_pieces_make_the_whole(monkeypatch):
    objective, parameters = problem(6, 101, 3, 4, 2)
    whole = objective.normal_equations(parameters)
    monkeypatch.setattr("flexsurr.training.one_hidden_layer.CHUNK", 7 * 10)
    pieces = objective.normal_equations(parameters)
    np.testing.assert_allclose(pieces.gram, whole.gram, rtol=1e-12, atol=1e-12 * np.abs(whole.gram).max())
    np.testing.assert_allclose(pieces.gradient, whole.gradient, rtol=1e-11, atol=1e-13)
    assert pieces.loss == pytest.approx(whole.loss, rel=1e-13)


def test_the_loss_is_the_nmse_averaged_over_outputs():
    objective, parameters = problem(1, 40, 3, 4, 2)
    errors = objective.outputs(parameters) - objective.y
    nmse = np.mean(errors**2, axis=0) / np.var(objective.y, axis=0)
    assert objective.loss(parameters) == pytest.approx(nmse.mean())


def test_levenberg_marquardt_finds_a_network_of_the_same_size():
    objective, start = problem(4, 200, 3, 5, 2)
    truth = np.random.default_rng(3).standard_normal(start.size)
    reachable = OneHiddenLayer.of_map(objective.x, objective.outputs(truth), 5, "tanh")
    optimiser = LevenbergMarquardt(reachable, start)
    losses = [optimiser.epoch() for _ in range(120)]
    assert np.all(np.diff(losses) <= 0.0)
    assert losses[-1] < 1e-8
