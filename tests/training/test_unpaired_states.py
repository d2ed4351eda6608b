"""A network without structure takes states that are no pairs, here the Lorenz equations'."""

import numpy as np
import pytest

from flexsurr.config.study import Integrator
from flexsurr.config.trial import trial_of
from flexsurr.simulation import simulate
from flexsurr.surrogates import HNN, compiled, load, save
from flexsurr.training import fit, split_dataset

NAMES, UNITS = ("x", "y", "z"), ("1", "1", "1")


def lorenz(states):
    x, y, z = states.T
    return np.stack([10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z], axis=-1)


def test_three_states_are_learned_kept_and_stepped(tmp_path):
    states = np.random.default_rng(0).uniform([-15, -15, 5], [15, 15, 40], size=(600, 3))
    dataset = split_dataset(
        np.arange(600),
        states,
        lorenz(states),
        validation=range(500, 600),
        state_names=NAMES,
        state_units=UNITS,
    )
    trial = trial_of(architecture="mlp", hidden=(24,), activation="tanh", scaling="per_feature", epochs=80)
    surrogate = fit(trial, dataset, tmp_path).surrogate
    start = np.array([5.0, 5.0, 25.0])
    assert np.linalg.norm(surrogate.derivative(0.0, start) - lorenz(start)) < 0.02 * np.linalg.norm(
        lorenz(start)
    )
    save(surrogate, tmp_path / "weights.npz")
    again = compiled(load(tmp_path / "weights.npz"))
    trajectory = simulate(
        again, np.linspace(0.0, 0.2, 21), start, Integrator(method="scipy_dop853", rtol=1e-8, atol=1e-8)
    )
    assert trajectory.completed
    np.testing.assert_allclose(
        np.gradient(trajectory.x, trajectory.t, axis=0)[5:-5],
        surrogate.derivative(0.0, trajectory.x)[5:-5],
        rtol=0.1,
        atol=2.0,
    )
    with pytest.raises(ValueError, match="pairs"):
        HNN(np.zeros(1), surrogate.scaling, NAMES, UNITS, hidden=(4,), activation="tanh")
