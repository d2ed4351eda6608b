"""Derivatives by the weights, closed-form, against torch's automatic ones."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from oscillator import free_responses, network, three_pairs

from flexsurr.surrogates.torch_module import field
from flexsurr.training import nmse
from flexsurr.training.networks import to_torch
from flexsurr.training.objective import Objective

SHAPES = [
    ("hnn", (5,)),
    ("mlp", (5,)),
    ("hnn", (4, 3)),
    ("mlp", (4, 3, 2)),
    ("dissipative_hnn", (4, 3)),
    ("dissipative_hnn", (4,)),
]
DATASETS = {"one pair": free_responses(4, 20), "three pairs": three_pairs()}


def automatic_jacobian(surrogate, x):
    """∂f/∂θ (m, 2r, n) of the scaled field in the layout of `Network.parameters`."""
    module = to_torch(surrogate)
    rates = field(module, torch.from_numpy(x), create_graph=True)
    rows = [
        torch.cat(
            [
                block.T.reshape(-1) if block.ndim == 2 else block
                for block in torch.autograd.grad(f, module.parameters(), retain_graph=True)
            ]
        )
        for f in rates.reshape(-1)
    ]
    return torch.stack(rows).reshape(*x.shape, -1).numpy()


@pytest.mark.parametrize("data", DATASETS)
@pytest.mark.parametrize(("architecture", "hidden"), SHAPES)
def test_gradient_and_normal_equations(architecture, hidden, data, monkeypatch):
    dataset = DATASETS[data]
    surrogate = network(dataset, architecture, hidden)
    objective = Objective.of(surrogate, dataset.x_train, dataset.dx_train)
    # pieces smaller than the samples, and the last one smaller than the others
    monkeypatch.setattr(
        "flexsurr.training.objective.CHUNK", 7 * surrogate.parameter_count * dataset.x_train.shape[1]
    )
    monkeypatch.setattr("flexsurr.training.one_hidden_layer.CHUNK", 7 * hidden[0] * (hidden[0] + 1) // 2)

    jacobian = automatic_jacobian(surrogate, objective.x)
    residuals = surrogate.scaled_field(objective.x) - objective.y
    weighted = jacobian * (objective.output_weights / len(objective.x))[:, None]
    gradient = np.einsum("sin,si->n", weighted, residuals)
    gram = np.einsum("sin,sim->nm", weighted, jacobian)

    equations = objective.normal_equations(surrogate.parameters)
    np.testing.assert_allclose(equations.gram, gram, rtol=1e-10, atol=1e-12 * np.max(np.abs(gram)))
    np.testing.assert_allclose(
        equations.gradient, gradient, rtol=1e-10, atol=1e-12 * np.max(np.abs(gradient))
    )
    found = np.empty_like(gradient)
    losses = objective.gradient(surrogate.parameters, found), objective.loss(surrogate.parameters)
    np.testing.assert_allclose(found, 2 * gradient, rtol=1e-10, atol=1e-12 * np.max(np.abs(gradient)))
    expected = nmse(surrogate.derivative(0.0, dataset.x_train), dataset.dx_train)
    np.testing.assert_allclose([*losses, equations.loss], expected, rtol=1e-12)


@pytest.mark.parametrize(("architecture", "hidden"), SHAPES)
def test_how_residuals_bend_along_a_step(architecture, hidden):
    """Jᵀ of their second derivative, which differences of the field in NumPy give."""
    dataset = DATASETS["three pairs"]
    surrogate = network(dataset, architecture, hidden)
    objective = Objective.of(surrogate, dataset.x_train, dataset.dx_train)
    theta = surrogate.parameters
    step = 1e-2 * np.random.default_rng(0).standard_normal(theta.size)
    ahead, here, behind = (
        replace(surrogate, parameters=theta + sign * step).scaled_field(objective.x) for sign in (1, 0, -1)
    )
    weighted = (
        automatic_jacobian(surrogate, objective.x) * (objective.output_weights / len(objective.x))[:, None]
    )
    expected = np.einsum("sin,si->n", weighted, ahead - 2 * here + behind)
    found = objective.bend(theta, step)
    np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())


LOSSES = {
    "mean_square": lambda error: error.pow(2).mean(),
    # eqs. 11 and 12 as printed, and the mean over the samples
    "norms": lambda error: sum(half.norm(dim=1).mean() for half in error.chunk(2, dim=1)),
}


@pytest.mark.parametrize("minimised", LOSSES)
@pytest.mark.parametrize("architecture", ["hnn", "mlp", "dissipative_hnn"])
def test_the_losses_of_first_order_steps_are_torchs(architecture, minimised):
    dataset = DATASETS["three pairs"]
    surrogate = network(dataset, architecture, (4, 3))
    objective = replace(Objective.of(surrogate, dataset.x_train, dataset.dx_train), minimised=minimised)
    module = to_torch(surrogate)
    rates = field(module, torch.from_numpy(objective.x), create_graph=True)
    loss = LOSSES[minimised](rates - torch.from_numpy(objective.y))
    blocks = torch.autograd.grad(loss, module.parameters())
    expected = torch.cat([block.T.reshape(-1) if block.ndim == 2 else block for block in blocks]).numpy()
    found = np.empty_like(expected)
    assert objective.gradient(surrogate.parameters, found) == pytest.approx(loss.item(), rel=1e-12)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * np.max(np.abs(expected)))


def test_a_sample_without_error_has_no_gradient_of_its_norm():
    dataset = DATASETS["one pair"]
    surrogate = network(dataset, "mlp", (5,))
    exact = Objective.of(surrogate, dataset.x_train, surrogate.derivative(0.0, dataset.x_train))
    found = np.empty(surrogate.parameter_count)
    loss = replace(exact, minimised="norms").gradient(surrogate.parameters, found)
    assert loss == pytest.approx(0.0, abs=1e-12)
    assert np.all(np.isfinite(found))


def test_gradient_over_chosen_samples():
    dataset = DATASETS["one pair"]
    surrogate = network(dataset, "hnn", (5,))
    whole = Objective.of(surrogate, dataset.x_train, dataset.dx_train)
    chosen = np.array([3, 11, 4])
    part = replace(whole, x=whole.x[chosen], y=whole.y[chosen])
    part.__dict__["output_weights"] = whole.output_weights
    found, expected = np.empty((2, surrogate.parameter_count))
    assert whole.gradient(surrogate.parameters, found, chosen) == pytest.approx(
        part.gradient(surrogate.parameters, expected), rel=1e-13
    )
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_nmse_by_hand():
    """Errors (1, 1) on a target of variance 4, and (3, −3) on one of variance 9: (1/4 + 9/9) / 2."""
    target = np.array([[0.0, 1.0], [4.0, 7.0]])
    assert nmse(target + np.array([[1.0, 3.0], [1.0, -3.0]]), target) == pytest.approx(0.625)


def test_an_output_without_variance_has_no_nmse():
    with pytest.raises(ValueError, match="output 1 does not vary"):
        nmse(np.zeros((3, 2)), np.array([[0.0, 5.0], [1.0, 5.0], [2.0, 5.0]]))
