"""One trial: best weights kept, stopped, resumed, failed."""

import json
import time

import numpy as np
import pytest
from oscillator import free_responses

from flexsurr.config.trial import GiveUp, trial_of
from flexsurr.surrogates import load, save
from flexsurr.training import fit, nmse
from flexsurr.training.epochs import CHECKPOINT

DATASET = free_responses()
COMMON = {"hidden": (6,), "activation": "softplus"}
LM = trial_of(architecture="hnn", **COMMON, epochs=25)
ADAM = trial_of(
    architecture="hnn", **COMMON, optimiser="adam_cosine", epochs=25, batch_size=32, learning_rate=0.02
)
SINGLE = ADAM.model_copy(update={"optimiser": "adam", "precision": "single"})
BFGS = trial_of(architecture="hnn", **COMMON, optimiser="lbfgs", epochs=25)
POLYNOMIAL = trial_of(architecture="polynomial", degree=6, optimiser="least_squares")
ITERATIVE = {"levenberg_marquardt": LM, "adam_cosine": ADAM, "adam, single": SINGLE, "lbfgs": BFGS}


class Killed(Exception):
    """Stands for the end of a process."""


def kill_at(epoch):
    def report(done, *_):
        if done == epoch:
            raise Killed

    return report


@pytest.mark.parametrize("name", [*ITERATIVE, "least_squares"])
def test_what_a_fit_says_is_so(name, tmp_path):
    trial = ITERATIVE.get(name, POLYNOMIAL)
    seen = []
    result = fit(trial, DATASET, tmp_path, lambda *row: seen.append(row))
    assert (result.status, result.reason) == ("finished", "")
    assert list(result.history.columns) == ["epoch", "wall_s", "train_loss", "validation_loss", "processor_s"]
    assert result.history.epoch.tolist() == list(range(1, result.epochs + 1)) == [row[0] for row in seen]
    assert np.all(np.diff(result.history.wall_s) > 0.0)
    assert result.wall_s == result.history.wall_s.iloc[-1]
    best = result.history.validation_loss.to_numpy()[result.best_epoch - 1]
    assert best == result.history.validation_loss.min() == pytest.approx(result.validation_nmse, rel=1e-6)
    field = result.surrogate.derivative(0.0, DATASET.x_validation)
    assert result.validation_nmse == pytest.approx(nmse(field, DATASET.dx_validation), rel=1e-6)
    field = result.surrogate.derivative(0.0, DATASET.x_train)
    assert result.train_nmse == pytest.approx(nmse(field, DATASET.dx_train), rel=1e-6)
    assert result.validation_nmse < 0.3
    assert result.parameters == result.surrogate.parameters.size
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ITERATIVE)
def test_killed_and_resumed_is_as_uninterrupted(name, tmp_path, monkeypatch):
    trial = ITERATIVE[name]
    expected = fit(trial, DATASET, tmp_path / "whole")
    monkeypatch.setattr("flexsurr.training.epochs.CHECKPOINT_EVERY_S", 0.0)
    for epoch in (7, 16):
        with pytest.raises(Killed):
            fit(trial, DATASET, tmp_path / "killed", kill_at(epoch))
    resumed_at = []
    found = fit(trial, DATASET, tmp_path / "killed", lambda epoch, *_: resumed_at.append(epoch))
    assert resumed_at[0] == 16
    np.testing.assert_array_equal(found.surrogate.parameters, expected.surrogate.parameters)
    losses = ["train_loss", "validation_loss"]
    np.testing.assert_array_equal(found.history[losses], expected.history[losses])
    assert (found.epochs, found.best_epoch) == (expected.epochs, expected.best_epoch)
    assert np.all(np.diff(found.history.wall_s) > 0.0)
    assert list((tmp_path / "killed").iterdir()) == []


@pytest.mark.parametrize("other", ["seed", "dataset", "damaged", "foreign"])
def test_a_checkpoint_of_something_else_is_not_used(other, tmp_path, monkeypatch):
    monkeypatch.setattr("flexsurr.training.epochs.CHECKPOINT_EVERY_S", 0.0)
    with pytest.raises(Killed):
        fit(LM, DATASET, tmp_path, kill_at(5))
    trial, dataset, path = LM, DATASET, tmp_path / CHECKPOINT
    if other == "seed":
        trial = LM.model_copy(update={"seed": 1})
    elif other == "dataset":
        dataset = free_responses(seed=1)
    elif other == "damaged":
        path.write_bytes(path.read_bytes()[:-200])
    else:
        path.write_text(json.dumps({"weights": [1, 2]}))
    epochs = []
    fit(trial, dataset, tmp_path, lambda epoch, *_: epochs.append(epoch))
    assert epochs[0] == 1


def test_patience_ends_a_fit_and_the_best_weights_are_kept(tmp_path, monkeypatch):
    """A validation loss that falls for five epochs and rises from then on."""
    losses = iter([9.0, 5.0, 4.0, 3.0, 2.0, 1.0, *range(2, 100)])
    weights = []

    def validation_loss(self, parameters):
        weights.append(parameters.copy())
        return float(next(losses))

    monkeypatch.setattr("flexsurr.training.objective.Objective.loss", validation_loss)
    trial = ADAM.model_copy(update={"patience": 8})
    result = fit(trial, DATASET, tmp_path)
    assert (result.best_epoch, result.epochs) == (5, 13)
    np.testing.assert_array_equal(result.surrogate.parameters, weights[5])


def test_crumbs_are_not_worth_waiting_for(tmp_path, monkeypatch):
    """A tenth of a percent an epoch: kept as the best, but it does not keep a fit with patience alive."""
    losses = iter(0.999**k for k in range(100))
    monkeypatch.setattr("flexsurr.training.objective.Objective.loss", lambda *_: next(losses))
    result = fit(ADAM.model_copy(update={"patience": 5}), DATASET, tmp_path)
    assert (result.best_epoch, result.epochs) == (6, 6)


def test_few_samples_of_each_trajectory_train_and_all_validate(tmp_path):
    few = fit(LM.model_copy(update={"epochs": 3, "samples_per_trajectory": 5}), DATASET, tmp_path / "few")
    part = fit(LM.model_copy(update={"epochs": 3}), DATASET.thinned(5), tmp_path / "part")
    whole = fit(LM.model_copy(update={"epochs": 3}), DATASET, tmp_path / "whole")
    np.testing.assert_array_equal(few.surrogate.parameters, part.surrogate.parameters)
    assert few.validation_nmse == part.validation_nmse
    assert not np.array_equal(few.surrogate.parameters, whole.surrogate.parameters)


def test_the_samples_kept_of_a_trajectory_are_its_own_and_evenly_spread():
    thin = DATASET.thinned(5)
    np.testing.assert_array_equal(thin.x_validation, DATASET.x_validation)
    for number in np.unique(DATASET.trajectory_train):
        every = np.flatnonzero(DATASET.trajectory_train == number)
        kept = thin.x_train[thin.trajectory_train == number]
        places = [np.flatnonzero((DATASET.x_train[every] == x).all(axis=1))[0] for x in kept]
        assert (places[0], places[-1], len(places)) == (0, len(every) - 1, 5)
        assert np.ptp(np.diff(places)) <= 1
    assert len(DATASET.thinned(10**6).x_train) == len(DATASET.x_train)


def test_time_limit(tmp_path):
    trial = LM.model_copy(update={"epochs": 10**6, "time_limit_s": 0.05})
    result = fit(trial, DATASET, tmp_path)
    assert result.status == "finished"
    assert result.history.processor_s.iloc[-1] >= 0.05
    assert np.all(result.history.processor_s.iloc[:-1] < 0.05)
    assert result.processor_s == result.history.processor_s.iloc[-1]


def test_waiting_is_not_counted_against_the_time_limit(tmp_path):
    """A busy machine must not change a result."""
    trial = LM.model_copy(update={"epochs": 5, "time_limit_s": 60.0})
    waited = fit(trial, DATASET, tmp_path, report=lambda *_: time.sleep(0.05))
    assert waited.epochs == 5
    assert waited.processor_s < waited.wall_s - 0.15


def test_weights_that_leave_the_numbers_are_a_failure_with_a_reason(tmp_path):
    trial = SINGLE.model_copy(update={"learning_rate": 1e30})
    result = fit(trial, DATASET, tmp_path)
    assert result.status == "failed"
    assert "not finite after epoch" in result.reason
    assert np.all(np.isfinite(result.surrogate.parameters))
    assert result.epochs == len(result.history) < trial.epochs


def test_a_rate_that_only_makes_it_worse_is_a_failure_with_a_reason(tmp_path):
    result = fit(ADAM.model_copy(update={"learning_rate": 1e6}), DATASET, tmp_path)
    assert result.status == "failed"
    assert "validated better" in result.reason


def test_a_hopeless_trial_is_stopped_after_the_epochs_it_was_given(tmp_path):
    slow = ADAM.model_copy(update={"learning_rate": 1e-6})
    whole = fit(slow, DATASET, tmp_path)
    level = float(whole.history.validation_loss[:7].min())
    for above, epochs, status in ((0.99 * level, 7, "stopped"), (level, slow.epochs, "finished")):
        trial = slow.model_copy(update={"give_up": GiveUp(after_epochs=7, above_nmse=above)})
        result = fit(trial, DATASET, tmp_path)
        assert (result.status, result.epochs) == (status, epochs)
        assert bool(result.reason) == (status == "stopped")
    assert whole.epochs == slow.epochs


@pytest.mark.parametrize("killed_at", [None, 3])
def test_stopped_as_hopeless_it_keeps_its_best_weights_killed_before_or_not(killed_at, tmp_path, monkeypatch):
    monkeypatch.setattr("flexsurr.training.epochs.CHECKPOINT_EVERY_S", 0.0)
    rule = GiveUp(after_epochs=5, above_nmse=1e-9)
    trial = LM.model_copy(update={"give_up": rule, "keep": "last"})
    if killed_at is not None:
        with pytest.raises(Killed):
            fit(trial, DATASET, tmp_path, kill_at(killed_at))
    result = fit(trial, DATASET, tmp_path)
    assert (result.status, result.epochs) == ("stopped", 5)
    assert result.reason.endswith("after 5 epochs, above 1e-09")
    assert result.validation_nmse == result.best_validation_nmse
    np.testing.assert_array_equal(
        result.surrogate.parameters,
        fit(LM.model_copy(update={"epochs": 5}), DATASET, tmp_path).best.parameters,
    )
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("trial", [LM, POLYNOMIAL])
def test_results_are_reproducible_and_can_be_saved(trial, tmp_path):
    first, second = (fit(trial, DATASET, tmp_path).surrogate for _ in range(2))
    save(first, tmp_path / "weights.npz")
    np.testing.assert_array_equal(load(tmp_path / "weights.npz").parameters, second.parameters)


def test_seeds_differ(tmp_path):
    first = fit(LM, DATASET, tmp_path)
    second = fit(LM.model_copy(update={"seed": 1}), DATASET, tmp_path)
    assert first.validation_nmse != second.validation_nmse


def test_levenberg_marquardt_is_accurate(tmp_path):
    """Eight neurons, from a few hundred samples: far below what first-order methods reach."""
    trial = trial_of(architecture="hnn", hidden=(8,), activation="softplus", epochs=200)
    assert fit(trial, free_responses(12, 60), tmp_path).validation_nmse < 1e-6
