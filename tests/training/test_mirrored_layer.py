"""The normal equations of neurons with their mirror images against those of all neurons one by one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexsurr.surrogates.layers import layer_shapes, views
from flexsurr.surrogates.mirrored_mass import Images
from flexsurr.surrogates.packed import packed_size
from flexsurr.training.levenberg_marquardt import LevenbergMarquardt
from flexsurr.training.mirrored_layer import MirroredLayer
from flexsurr.training.one_hidden_layer import OneHiddenLayer

PLANES = {
    "none": np.empty((0, 3)),
    "one": np.array([[-1.0, -1.0, -1.0]]),
    "two": np.array([[1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]]),
}


def problem(seed, planes, hidden=3, samples=25):
    generator = np.random.default_rng(seed)
    images = Images.of(PLANES[planes])
    x = generator.uniform(-1.0, 1.0, (samples, 3))
    y = generator.uniform(-1.0, 1.0, (samples, packed_size(3)))
    weights = generator.uniform(0.1, 2.0, packed_size(3))
    objective = MirroredLayer(x, y, hidden, "atan", images, weights)
    return objective, generator.standard_normal(4 * hidden + (hidden + 1) * packed_size(3))


def with_images(objective, parameters):
    """All weights of the same network without a thought of mirrors, a linear function of `parameters`."""
    weights, biases, readout, constants = views(
        parameters, layer_shapes((3, objective.hidden, packed_size(3)))
    )
    parts = *objective.images.of_neurons(weights, biases, readout), constants
    return np.concatenate([part.ravel() for part in parts])


def alone(objective):
    hidden = objective.images.number * objective.hidden
    return OneHiddenLayer.of_map(objective.x, objective.y, hidden, "atan", objective.output_weights)


EVERY = given(seed=st.integers(0, 2**20), planes=st.sampled_from(list(PLANES)))


@settings(max_examples=20)
@EVERY
def test_they_are_those_of_all_neurons_bound_to_their_images(seed, planes):
    objective, parameters = problem(seed, planes)
    bound = np.array([with_images(objective, unit) for unit in np.eye(parameters.size)])
    # constants of entries that change their sign stay as they are
    still = np.zeros(parameters.size, dtype=bool)
    still[-packed_size(3) :] = objective.images.of_entries != 0
    bound[still] = 0.0
    expected = alone(objective).normal_equations(with_images(objective, parameters))
    found = objective.normal_equations(parameters)
    gram = bound @ expected.gram @ bound.T
    np.testing.assert_allclose(found.gram, gram, rtol=1e-9, atol=1e-12 * np.abs(gram).max())
    gradient = bound @ expected.gradient
    np.testing.assert_allclose(found.gradient, gradient, rtol=1e-9, atol=1e-12 * np.abs(gradient).max())
    assert found.loss == pytest.approx(expected.loss, rel=1e-12)
    assert objective.loss(parameters) == pytest.approx(expected.loss, rel=1e-12)


@settings(max_examples=20)
@EVERY
def test_residuals_bend_as_those_of_all_neurons_do(seed, planes):
    objective, parameters = problem(seed, planes)
    step = 0.1 * np.random.default_rng(seed + 1).standard_normal(parameters.size)
    step[-packed_size(3) :][objective.images.of_entries != 0] = 0.0
    bound = np.array([with_images(objective, unit) for unit in np.eye(parameters.size)])
    bound[-packed_size(3) :][objective.images.of_entries != 0] = 0.0
    expected = bound @ alone(objective).bend(with_images(objective, parameters), with_images(objective, step))
    found = objective.bend(parameters, step)
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("planes", PLANES)
def test_a_network_of_the_same_size_is_found(planes):
    objective, start = problem(6, planes, samples=200)
    start[-packed_size(3) :][objective.images.of_entries != 0] = 0.0
    truth = np.random.default_rng(3).standard_normal(start.size)
    truth[-packed_size(3) :][objective.images.of_entries != 0] = 0.0
    reachable = MirroredLayer(
        objective.x, objective.outputs(truth), 3, "atan", objective.images, objective.output_weights
    )
    optimiser = LevenbergMarquardt(reachable, start)
    losses = [optimiser.epoch() for _ in range(100)]
    assert np.all(np.diff(losses) <= 0.0)
    assert losses[-1] < 1e-6 * losses[0]
