"""Weights that the residuals are linear in: at their least squares after every step."""

import numpy as np
import pytest
from oscillator import free_responses, network

from flexsurr.surrogates.mirrored_mass import Images
from flexsurr.surrogates.packed import packed_size
from flexsurr.training.levenberg_marquardt import LevenbergMarquardt, Separable, settling
from flexsurr.training.mirrored_layer import MirroredLayer
from flexsurr.training.objective import Objective
from flexsurr.training.one_hidden_layer import OneHiddenLayer

HIDDEN = 4
OSCILLATOR = free_responses(4, 25)


def of_map():
    generator = np.random.default_rng(1)
    x, y = generator.uniform(-1.0, 1.0, (60, 3)), generator.uniform(-1.0, 1.0, (60, 2))
    parameters = generator.standard_normal(4 * HIDDEN + (HIDDEN + 1) * 2)
    objective = OneHiddenLayer.of_map(x, y, HIDDEN, "tanh", np.array([0.2, 3.0]))
    return objective, parameters, np.arange(4 * HIDDEN, parameters.size)


def of_mirrored():
    generator = np.random.default_rng(2)
    images, entries = Images.of(np.array([[1.0, -1.0, -1.0]])), packed_size(3)
    x, y = generator.uniform(-1.0, 1.0, (60, 3)), generator.uniform(-1.0, 1.0, (60, entries))
    objective = MirroredLayer(x, y, HIDDEN, "atan", images, generator.uniform(0.1, 2.0, entries))
    parameters = generator.standard_normal(4 * HIDDEN + (HIDDEN + 1) * entries)
    still = parameters.size - entries + np.flatnonzero(images.of_entries != 0)
    assert 0 < still.size < entries
    return objective, parameters, np.setdiff1d(np.arange(4 * HIDDEN, parameters.size), still)


PROBLEMS = {"map": of_map, "mirrored": of_mirrored}


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_they_are_where_the_whole_matrix_has_them(problem):
    """One undamped step in these alone, by their block of JᵀJ; all others stay."""
    objective, parameters, linear = problem()
    equations = objective.normal_equations(parameters)
    expected = parameters.copy()
    expected[linear] -= np.linalg.solve(equations.gram[np.ix_(linear, linear)], equations.gradient[linear])
    found = objective.settled(parameters)
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-7 * np.abs(expected).max())
    np.testing.assert_array_equal(np.delete(found, linear), np.delete(parameters, linear))
    assert objective.loss(found) < objective.loss(parameters)
    for nudge in np.random.default_rng(3).standard_normal((5, linear.size)):
        beside = found.copy()
        beside[linear] += 0.1 * nudge
        assert objective.loss(beside) > objective.loss(found)


def test_what_nothing_depends_on_stays_and_equals_share():
    """The shortest of many solutions: a zero column moves nothing, equal ones alike."""
    column = np.array([1.0, 2.0, -1.0])
    jacobian = np.stack([column, np.zeros(3), column], axis=1)
    moved = settling(jacobian.T @ jacobian, jacobian.T @ -column)
    np.testing.assert_allclose(moved, [0.5, 0.0, 0.5], rtol=1e-3)


class Unsettled:
    """The same sum of squares, which does not say that it is linear in anything."""

    def __init__(self, objective):
        self.loss, self.normal_equations = objective.loss, objective.normal_equations
        self.bend = objective.bend


def test_networks_that_settle_come_further_in_as_many_steps():
    surrogate = network(OSCILLATOR, "mlp", activation="atan")
    field = Objective.of(surrogate, OSCILLATOR.x_train, OSCILLATOR.dx_train)
    objective = OneHiddenLayer.of_field(surrogate, field.x, field.y, field.output_weights)
    settled, plain = (
        LevenbergMarquardt(which, surrogate.parameters) for which in (objective, Unsettled(objective))
    )
    losses = np.array([[optimiser.epoch() for _ in range(12)] for optimiser in (settled, plain)])
    assert np.all(np.diff(losses) <= 0.0)
    assert losses[0, 0] < losses[1, 0]
    assert losses[0, -1] < 0.5 * losses[1, -1]


def test_fields_do_not_settle():
    """Noisy rates would make large weights of them, and responses without bound."""
    surrogate = network(OSCILLATOR, "hnn")
    assert not isinstance(Objective.of(surrogate, OSCILLATOR.x_train, OSCILLATOR.dx_train), Separable)
