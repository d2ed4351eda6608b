"""Errors of a field on trajectories that no training has seen."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexsurr.evaluation.scores import held_out_errors
from flexsurr.training.dataset import split_dataset

NAMES, UNITS = ("eta_1", "p_1"), ("rad", "kg m²/s")


def errors(predict):
    random = np.random.default_rng(0)
    x, dx = random.normal(size=(2, 40, 2)) * [1.0, 100.0]
    trajectory = np.repeat([0, 1], 20)
    dataset = split_dataset(trajectory, x, dx, validation=(1,), state_names=NAMES, state_units=UNITS)
    field = predict(x, dx)
    surrogate = SimpleNamespace(
        state_names=NAMES, derivative=lambda t, states: field[np.searchsorted(trajectory, 1) :]
    )
    return held_out_errors(surrogate, dataset)


def test_the_exact_field_has_none_and_a_constant_one_has_the_variance():
    assert errors(lambda x, dx: dx)["held_out_nmse"] == 0.0
    mean = errors(lambda x, dx: np.broadcast_to(dx[20:].mean(axis=0), dx.shape))
    assert mean["held_out_nmse"] == pytest.approx(1.0)


def test_every_state_counts_alike_whatever_its_size():
    one_wrong = errors(lambda x, dx: dx + [0.0, 0.1] * dx[20:].std(axis=0))
    assert one_wrong["held_out_nmse_by_state"] == {"eta_1": 0.0, "p_1": pytest.approx(0.01)}
    assert one_wrong["held_out_nmse"] == pytest.approx(0.005)


def test_a_field_that_is_not_finite_claims_nothing():
    broken = errors(lambda x, dx: dx + np.array([np.nan, 0.0]))
    assert broken["held_out_nmse"] is None
    assert broken["held_out_nmse_by_state"] == {"eta_1": None, "p_1": 0.0}
