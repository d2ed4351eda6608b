"""The structured normal equations against the Jacobian that they do without."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from flexsurr.training.levenberg_marquardt import LevenbergMarquardt
from flexsurr.training.structured_normal_equations import MapObjective


def problem(seed, samples, inputs, hidden, outputs, activation="tanh"):
    generator = np.random.default_rng(seed)
    x = generator.uniform(-1.0, 1.0, (samples, inputs))
    y = generator.uniform(-1.0, 1.0, (samples, outputs)) * generator.uniform(0.1, 3.0, outputs)
    count = (inputs + 1) * hidden + (hidden + 1) * outputs
    objective = MapObjective.of(x, y, hidden, activation)
    return objective, generator.standard_normal(count)


def dense(objective, parameters):
    """Weighted residuals and their Jacobian by automatic differentiation of the same network in torch."""
    x, y = torch.tensor(objective.x), torch.tensor(objective.y)
    n, h, k = x.shape[1], objective.hidden, y.shape[1]
    function = {"tanh": torch.tanh, "atan": torch.atan}[objective.activation]
    roots = torch.tensor(np.sqrt(objective.weights / len(objective.x)))

    def residuals(p):
        weights, biases, weights_out, biases_out = torch.split(p, [n * h, h, h * k, k])
        hidden = function(x @ weights.reshape(n, h) + biases)
        return (roots * (hidden @ weights_out.reshape(h, k) + biases_out - y)).ravel()

    p = torch.tensor(parameters)
    jacobian = torch.autograd.functional.jacobian(residuals, p)
    return residuals(p).numpy(), jacobian.numpy()


@settings(max_examples=25)
@given(
    seed=st.integers(0, 2**20),
    inputs=st.integers(1, 5),
    hidden=st.integers(1, 6),
    outputs=st.integers(1, 4),
    activation=st.sampled_from(["tanh", "atan"]),
)
def test_they_are_the_squares_of_the_jacobian(seed, inputs, hidden, outputs, activation):
    objective, parameters = problem(seed, 20, inputs, hidden, outputs, activation)
    residuals, jacobian = dense(objective, parameters)
    equations = objective.normal_equations(parameters)
    gram = jacobian.T @ jacobian
    np.testing.assert_allclose(equations.gram, gram, rtol=1e-9, atol=1e-12 * np.abs(gram).max())
    np.testing.assert_allclose(equations.gradient, jacobian.T @ residuals, rtol=1e-9, atol=1e-10)
    assert equations.loss == pytest.approx(residuals @ residuals, rel=1e-12)
    assert objective.loss(parameters) == pytest.approx(equations.loss, rel=1e-12)


def test_the_loss_is_the_nmse_averaged_over_outputs():
    objective, parameters = problem(1, 40, 3, 4, 2)
    nmse = np.mean(objective.residuals(parameters) ** 2, axis=0) / np.var(objective.y, axis=0)
    assert objective.loss(parameters) == pytest.approx(nmse.mean())


def test_levenberg_marquardt_finds_a_network_of_the_same_size():
    objective, start = problem(2, 200, 3, 5, 2)
    truth = np.random.default_rng(3).standard_normal(start.size)
    reachable = MapObjective.of(objective.x, objective.residuals(truth) + objective.y, 5, "tanh")
    optimiser = LevenbergMarquardt(reachable, start)
    losses = [optimiser.epoch() for _ in range(120)]
    assert np.all(np.diff(losses) <= 0.0)
    assert losses[-1] < 1e-8
