"""The torch modules are the same networks."""

import subprocess
import sys

import numpy as np
import pytest
import torch
from oscillator import free_responses, network, three_pairs

from flexsurr.simulation.rhs import Model
from flexsurr.surrogates import ACTIVATIONS
from flexsurr.training import torch_model
from flexsurr.training.networks import ACTIVATIONS as TORCH_ACTIVATIONS
from flexsurr.training.networks import from_torch, to_torch

DATASET = free_responses(4, 10)


def test_every_activation_is_there():
    assert set(TORCH_ACTIVATIONS) == set(ACTIVATIONS)


@pytest.mark.parametrize("architecture", ["hnn", "mlp", "dissipative_hnn"])
@pytest.mark.parametrize("activation", TORCH_ACTIVATIONS)
def test_same_field(architecture, activation):
    for dataset, hidden in ((DATASET, (9,)), (three_pairs(), (6, 4))):
        surrogate = network(dataset, architecture, hidden, activation)
        model = torch_model(surrogate)
        assert isinstance(model, Model)
        found = np.array([model.derivative(0.0, x) for x in dataset.x_train])
        expected = surrogate.derivative(0.0, dataset.x_train)
        assert np.all(np.abs(found - expected) <= 1e-12 * np.max(np.abs(expected), axis=0))


@pytest.mark.parametrize("architecture", ["hnn", "mlp", "dissipative_hnn"])
def test_weights_there_and_back(architecture):
    surrogate = network(DATASET, architecture, (7, 5), "silu", seed=1)
    other = network(DATASET, architecture, (7, 5), "silu", seed=2)
    np.testing.assert_array_equal(from_torch(to_torch(surrogate), other).parameters, surrogate.parameters)


def test_single_precision():
    surrogate = network(DATASET, "hnn", (7,), "tanh")
    found = torch_model(surrogate, torch.float32).derivative(0.0, DATASET.x_train)
    expected = surrogate.derivative(0.0, DATASET.x_train)
    assert 0.0 < np.max(np.abs(found - expected)) < 1e-5 * np.max(np.abs(expected))


def test_torch_is_imported_only_when_it_is_used():
    """Least squares and the expansion of a sweep should not wait for it."""
    script = "import sys; from flexsurr.training import expand, fit; sys.exit('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0
