"""From samples to a map, and how well it does."""

import dataclasses

import numpy as np
import pytest

from flexsurr.aerodynamics.features import (
    COEFFICIENT_UNITS,
    COEFFICIENTS,
    FEATURE_UNITS,
    FEATURES,
    OUTPUT_GROUPS,
)
from flexsurr.config.trial import GiveUp, trial_of
from flexsurr.storage import SampleMetadata, Samples
from flexsurr.surrogates import load_map, save_map
from flexsurr.training import fit_map, fit_polynomial_map
from flexsurr.training.epochs import Ending
from flexsurr.training.map_data import accuracy, held_out_errors, map_data

LOW, HIGH = np.array([-2.0, 0.0, 100.0]), np.array([1.0, 0.5, 300.0])


def quadratic_samples(count: int = 300) -> Samples:
    u = LOW + (HIGH - LOW) * np.random.default_rng(5).uniform(size=(count, 3))
    a, b, c = (u / np.array([1.0, 0.1, 100.0])).T
    y = np.stack([1.0 + a * b - c, a**2 - 0.3 * c * b + 2.0], axis=1)
    metadata = SampleMetadata(
        "airliner",
        "pseudo_random",
        0,
        "abc",
        0,
        count,
        ("a", "b", "c"),
        ("1", "1", "m"),
        tuple(LOW),
        tuple(HIGH),
        ("y1", "y2"),
        ("1", "1"),
    )
    return Samples(u, y, metadata)


DATA = map_data(quadratic_samples(), held_out=0.2, seed=1)
TRIAL = trial_of(architecture="network", hidden=(8,), activation="tanh", epochs=30)


def test_a_fifth_is_held_out_and_features_are_scaled_to_one():
    assert DATA.held_out.sum() == 60
    assert np.abs(DATA.scaled_u).max() <= 1.0
    training = DATA.scaled_y[~DATA.held_out]
    np.testing.assert_allclose([training.min(axis=0), training.max(axis=0)], [[-1.0, -1.0], [1.0, 1.0]])
    again = map_data(quadratic_samples(), held_out=0.2, seed=1)
    np.testing.assert_array_equal(again.held_out, DATA.held_out)
    assert again.sha256 == DATA.sha256
    assert map_data(quadratic_samples(), held_out=0.2, seed=2).sha256 != DATA.sha256


def test_a_coefficient_that_does_not_vary_is_named():
    samples = quadratic_samples()
    flat = dataclasses.replace(samples, y=np.column_stack([samples.y[:, 0], np.ones(len(samples.y))]))
    with pytest.raises(ValueError, match="y2 does not vary"):
        map_data(flat, 0.2, 1)


def test_the_quadratic_baseline_is_exact_for_a_quadratic_function():
    training = DATA.u[~DATA.held_out], DATA.y[~DATA.held_out]
    quadratic, linear = (
        accuracy(DATA, fit_polynomial_map(DATA.inputs, *training, ("y1", "y2"), degree)(DATA.u), name)
        for name, degree in (("quadratic", 2), ("linear", 1))
    )
    assert quadratic["validation_nmse"].max() < 1e-20
    assert linear["validation_nmse"].min() > 1e-3
    assert list(quadratic.columns) == ["output", "train_nmse", "validation_nmse", "validation_r2", "model"]


def test_accuracy_is_relative_to_the_variance():
    predicted = DATA.y + 0.1 * np.std(DATA.y[DATA.held_out], axis=0)
    table = accuracy(DATA, predicted, "network")
    np.testing.assert_allclose(table["validation_nmse"], 0.01)
    np.testing.assert_allclose(table["validation_r2"], 0.99)
    errors = held_out_errors(DATA, predicted)
    np.testing.assert_allclose(errors[["error_y1", "error_y2"]], 0.1)
    assert len(errors) == 60


def test_a_network_learns_and_its_losses_are_those_of_the_table(tmp_path):
    fit = fit_map(TRIAL, DATA, tmp_path)
    assert fit.status == "finished"
    assert fit.epochs == 30
    table = accuracy(DATA, fit.surrogate(DATA.u), "network")
    assert table["validation_r2"].min() > 0.999
    assert fit.train_nmse == pytest.approx(table["train_nmse"].mean(), rel=1e-9)
    assert fit.validation_nmse == pytest.approx(table["validation_nmse"].mean(), rel=1e-9)
    assert fit.validation_nmse == pytest.approx(fit.history["validation_loss"].min(), rel=1e-9)


def test_interrupted_and_resumed_it_comes_to_the_same_weights(tmp_path, monkeypatch):
    whole = fit_map(TRIAL, DATA, tmp_path / "whole")
    monkeypatch.setattr("flexsurr.training.epochs.CHECKPOINT_EVERY_S", 0.0)

    def interrupt(epoch, *losses):
        if epoch == 12:
            raise KeyboardInterrupt

    folder = tmp_path / "resumed"
    with pytest.raises(KeyboardInterrupt):
        fit_map(TRIAL, DATA, folder, interrupt)
    epochs = []
    resumed = fit_map(TRIAL, DATA, folder, lambda epoch, *losses: epochs.append(epoch))
    assert epochs[0] == 12  # the eleventh was the last to be kept
    np.testing.assert_array_equal(resumed.surrogate.parameters, whole.surrogate.parameters)
    assert list(folder.iterdir()) == []


def test_four_networks_are_the_four_fits_of_their_outputs(tmp_path):
    rng = np.random.default_rng(0)
    y = quadratic_samples().y @ rng.normal(size=(2, len(COEFFICIENTS)))
    names = {"output_names": COEFFICIENTS, "output_units": COEFFICIENT_UNITS}
    samples = quadratic_samples()
    metadata = dataclasses.replace(samples.metadata, **names)
    data = map_data(dataclasses.replace(samples, y=y, metadata=metadata), 0.2, 1)
    trial = TRIAL.model_copy(update={"hidden": (4,), "epochs": 5, "networks": "four"})
    reported = []
    fit = fit_map(trial, data, tmp_path, lambda epoch, *losses: reported.append(epoch))
    assert reported == list(range(1, 21))
    assert list(tmp_path.iterdir()) == []
    assert (fit.surrogate.hidden, fit.surrogate.output_names) == (16, COEFFICIENTS)
    single = trial.model_copy(update={"networks": "one"})
    for name, outputs in OUTPUT_GROUPS.items():
        alone = fit_map(single, data.only(outputs), tmp_path)
        places = [COEFFICIENTS.index(output) for output in outputs]
        np.testing.assert_allclose(fit.surrogate(data.u)[:, places], alone.surrogate(data.u), atol=1e-12)
        losses = fit.history.loc[fit.history["outputs"] == name, "train_loss"]
        np.testing.assert_array_equal(losses, alone.history["train_loss"])


def test_of_four_networks_the_worst_end_is_that_of_all_with_every_reason():
    given_up, blown = Ending("stopped", "above 0.5"), Ending("failed", "not finite")
    assert Ending.of_all({"drag": Ending(), "modal": Ending()}) == Ending()
    assert Ending.of_all({"all": given_up}) == given_up
    assert Ending.of_all({"drag": Ending(), "modal": given_up}) == Ending("stopped", "modal: above 0.5")
    both = Ending.of_all({"drag": blown, "modal": given_up})
    assert both == Ending("failed", "drag: not finite; modal: above 0.5")


def test_a_hopeless_map_is_stopped(tmp_path):
    rule = GiveUp(after_epochs=3, above_nmse=1e-9)
    result = fit_map(TRIAL.model_copy(update={"give_up": rule}), DATA, tmp_path)
    assert (result.status, result.epochs) == ("stopped", 3)
    assert "above 1e-09" in result.reason


def test_with_second_order_terms_a_product_of_two_features_is_learned_by_less(tmp_path):
    """α η_1 is among the further inputs; a network of a single neuron cannot make it of the features."""
    u = np.random.default_rng(3).uniform(-1.0, 1.0, (400, len(FEATURES)))
    eta = FEATURES.index("eta_1")
    y = 1e-2 * (u[:, [2]] * u[:, [eta]] + u[:, [3]])
    ones = (1.0,) * len(FEATURES)
    metadata = dataclasses.replace(
        quadratic_samples().metadata,
        count=400,
        input_names=FEATURES,
        input_units=FEATURE_UNITS,
        input_low=tuple(-one for one in ones),
        input_high=ones,
        output_names=("y",),
        output_units=("1",),
    )
    data = map_data(Samples(u, y, metadata), 0.2, 1)
    plain = TRIAL.model_copy(update={"hidden": (1,), "epochs": 20})
    second = plain.model_copy(update={"inputs": "second_order"})
    errors = [fit_map(trial, data, tmp_path).validation_nmse for trial in (plain, second)]
    assert errors[1] < 0.1 * errors[0]


def test_lbfgs_lessens_the_loss_too(tmp_path):
    trial = trial_of(**TRIAL.model_dump() | {"optimiser": "lbfgs", "epochs": 40})
    fit = fit_map(trial, DATA, tmp_path)
    losses = fit.history["train_loss"]
    assert losses.iloc[-1] < 0.1 * losses.iloc[0]


def test_the_last_weights_are_kept_where_the_trial_says_so(tmp_path):
    """Of noisy samples the best are not the last: the network goes on to fit the noise of those it sees."""
    samples = quadratic_samples(120)
    noise = np.random.default_rng(7).standard_normal(samples.y.shape)
    data = map_data(dataclasses.replace(samples, y=samples.y + 0.5 * noise), 0.5, 1)
    trial = TRIAL.model_copy(update={"keep": "last", "epochs": 60})
    last, best = (
        fit_map(trial.model_copy(update={"keep": keep}), data, tmp_path) for keep in ("last", "best")
    )
    assert last.best_epoch == best.best_epoch < 60
    np.testing.assert_array_equal(last.best.parameters, best.surrogate.parameters)
    assert last.train_nmse < best.train_nmse
    assert last.validation_nmse > best.validation_nmse == best.best_validation_nmse


def test_a_polynomial_comes_back_from_its_file(tmp_path):
    trial = trial_of(architecture="quadratic", optimiser="least_squares")
    fit = fit_map(trial, DATA, tmp_path)
    assert (fit.status, fit.epochs) == ("finished", 1)
    save_map(fit.surrogate, tmp_path / "weights.npz")
    again = load_map(tmp_path / "weights.npz")
    np.testing.assert_array_equal(again(DATA.u), fit.surrogate(DATA.u))
    assert fit.parameters == again.parameter_count == 20
