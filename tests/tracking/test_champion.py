"""The champion of a study: a registered model that predicts what the surrogate in its file does."""

import json
import shutil
from pathlib import Path

import mlflow
import numpy as np
import pandas as pd
import pytest
from mlflow import MlflowClient
from run_folders import described, write_run

import flexsurr
from flexsurr.cli.tracking import store, track
from flexsurr.surrogates import Intervals, PolynomialHamiltonian, PolynomialMap, save_map
from flexsurr.surrogates.scaling import PairScaling
from flexsurr.tracking.store import read_store, store_uri
from flexsurr.tracking.trial import tracked
from flexsurr.training.saved_surrogate import SavedSurrogate, save_surrogate

pytestmark = pytest.mark.filterwarnings("ignore::pandas.errors.Pandas4Warning")  # MLflow's own
MODEL = "cantilever-hamiltonian"
PARAMS = {"duration_s": 0.5, "step_s": 0.05}
AT_REST = pd.DataFrame({"eta_1": [1.0], "p_1": [0.0]})


def oscillator(stiffness: float, key: str) -> SavedSurrogate:
    """A mass on a spring, H = p²/2 + stiffness q²/2."""
    surrogate = PolynomialHamiltonian(
        parameters=np.array([0.5, 0.5 * stiffness]),
        exponents=np.array([[0, 2], [2, 0]]),
        scaling=PairScaling((1.0,), 1.0, 1.0),
        state_names=("eta_1", "p_1"),
        state_units=("rad", "kg m²/s"),
    )
    low, high = np.array([-1.0, -4.0]), np.array([1.0, 4.0])
    return SavedSurrogate(surrogate, "cantilever", "hamiltonian", key, low, high, None)


def choose(results: Path, key: str, error: float, **others: float) -> None:
    """Write the selection: one of `key`, and `others` by name with their errors."""
    entries = {
        name: {"run_id": which, "study": "cantilever", "status": "finished", "validation_nmse": 2e-7}
        | {"long_response_error_percent_worst": each, "chosen_by": {"error_at_most_percent": None}}
        for name, which, each in [("hnn", key, error), *((run, run, e) for run, e in others.items())]
    }
    path = results / "selected/cantilever.json"
    path.parent.mkdir(exist_ok=True)
    best = min(entries, key=lambda name: entries[name]["long_response_error_percent_worst"])
    path.write_text(json.dumps({"hamiltonian": {"pareto": [], "chosen": best, **entries}}))


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> Path:
    """Results of two surrogates, of which the first is the champion."""
    results = tmp_path_factory.mktemp("results")
    store({"uri": None, "studies": ["cantilever"]}, results / "mlflow/store.json")
    for key, stiffness in (("hnn-1", 4.0), ("hnn-2", 9.0)):
        (results / "runs" / key).mkdir(parents=True)
        save_surrogate(oscillator(stiffness, key), results / "runs" / key / "weights.npz")
        folder = write_run(results / "runs", key)
        with tracked(read_store(results / "mlflow/store.json"), described(key), folder) as trial:
            trial.keep()
    choose(results, "hnn-2", 3.0, **{"hnn-1": 0.5})
    track(results, sync=False, uri=None)
    return results


@pytest.fixture
def loaded(results):
    """A function that loads the champion of a store, by default that of `results`."""

    def load(folder: Path = results / "mlflow"):
        mlflow.set_tracking_uri(store_uri(None, folder))
        return mlflow.pyfunc.load_model(f"models:/{MODEL}@champion")

    yield load
    mlflow.set_tracking_uri(None)


def test_the_champion_predicts_what_the_file_does(results, loaded):
    champion = loaded()
    states = pd.DataFrame({"p_1": [0.0, 1.0], "eta_1": [0.5, -0.2]})
    responses = champion.predict(states, params=PARAMS)
    ours = flexsurr.load_surrogate(results / "runs/hnn-1/weights.npz")
    for number, initial in enumerate(states.to_dict("records")):
        expected = ours.simulate(initial=initial, **PARAMS).table()
        found = responses[responses["response"] == number].drop(columns="response").reset_index(drop=True)
        pd.testing.assert_frame_equal(found, expected)
    assert responses["eta_1"].iloc[10] == pytest.approx(0.5 * np.cos(2.0 * 0.5), rel=1e-6)


def test_it_has_a_signature_that_its_predictions_have(results, loaded):
    metadata = loaded().metadata
    client = MlflowClient(store_uri(None, results / "mlflow"))
    example = metadata.load_input_example(client.get_model_version_by_alias(MODEL, "champion").source)
    assert metadata.signature.inputs.input_names() == ["eta_1", "p_1"]
    predicted = loaded().predict(example, params=PARAMS)
    assert metadata.signature.outputs.input_names() == list(predicted.columns)
    with pytest.raises(mlflow.MlflowException, match="p_1"):
        loaded().predict(example.drop(columns="p_1"))


def test_its_card_says_what_it_is(results):
    client = MlflowClient(store_uri(None, results / "mlflow"))
    version = client.get_model_version_by_alias(MODEL, "champion")
    card = version.description
    for words in (
        "Of all runs it has the least worst error of a response.",
        "polynomial",
        "2 parameters",
        "trained with",
        "-1 to 1",
        "0.5",
        f"models:/{MODEL}@champion",
    ):
        assert words in card
    assert client.get_registered_model(MODEL).description == card
    assert client.get_run(version.run_id).data.tags["flexsurr.run_id"] == "hnn-1"


def test_nothing_of_it_is_pickled(results):
    client = MlflowClient(store_uri(None, results / "mlflow"))
    version = client.get_model_version_by_alias(MODEL, "champion")
    files = list(Path(version.source.removeprefix("file://")).rglob("*"))
    assert any(path.name == "weights.npz" for path in files)
    assert [path for path in files if path.suffix in (".pkl", ".pickle", ".pth", ".py")] == []


def test_another_choice_is_another_version_and_the_first_again_is_none(results, tmp_path, loaded):
    moved = shutil.copytree(results, tmp_path / "moved")
    client = MlflowClient(store_uri(None, moved / "mlflow"))
    stiffness = {}
    for key in ("hnn-2", "hnn-2", "hnn-1"):
        choose(moved, key, 0.1)
        track(moved, sync=False, uri=None)
        version = client.get_model_version_by_alias(MODEL, "champion")
        assert version.tags["flexsurr.run_id"] == key
        assert version.source.startswith((moved / "mlflow/artifacts/cantilever").as_uri())
        response = loaded(moved / "mlflow").predict(AT_REST, params=PARAMS)
        stiffness[key] = response["energy_J"].iloc[0] * 2.0
    assert stiffness == {"hnn-2": pytest.approx(9.0), "hnn-1": pytest.approx(4.0)}
    assert len(client.search_model_versions(f"name = '{MODEL}'")) == 2


def test_a_moved_folder_keeps_its_champion(results, tmp_path, loaded):
    moved = shutil.copytree(results, tmp_path / "moved")
    store({"uri": None, "studies": ["cantilever"]}, moved / "mlflow/store.json")
    away = results.rename(results.with_name("away"))
    try:
        response = loaded(moved / "mlflow").predict(AT_REST, params=PARAMS)
    finally:
        away.rename(results)
    assert response["energy_J"].iloc[0] == pytest.approx(2.0)


def test_of_maps_the_network_that_flies_is_the_champion(tmp_path):
    """It predicts what the map in its file does, row by row, whatever the order of the columns."""
    inputs = Intervals(("mach", "alpha"), np.array([0.6, -0.1]), np.array([0.8, 0.2]))
    exponents = np.array([[0, 0], [1, 0], [1, 1]])
    learned = PolynomialMap(
        inputs, ("lift", "drag"), exponents, np.array([[1.0, 2.0], [0.5, 0.1], [3.0, 0.0]])
    )
    results = tmp_path / "results"
    store({"uri": None, "studies": ["cantilever"]}, results / "mlflow/store.json")
    (results / "runs/network-1").mkdir(parents=True)
    save_map(learned, results / "runs/network-1/weights.npz")
    folder = write_run(results / "runs", "network-1")
    with tracked(read_store(results / "mlflow/store.json"), described("network-1"), folder) as trial:
        trial.keep()
    rule = {"chosen_by": {"nmse_at_most": 1e-6}}
    chosen = {
        label: {"run_id": "network-1", "validation_nmse": 2e-7, **rule} for label in ("network", "linear")
    }
    (results / "selected").mkdir()
    (results / "selected/cantilever.json").write_text(json.dumps(chosen))
    track(results, sync=False, uri=None)
    uri = store_uri(None, results / "mlflow")
    (name,) = [model.name for model in MlflowClient(uri).search_registered_models()]
    assert name == "cantilever-network"
    mlflow.set_tracking_uri(uri)
    try:
        champion = mlflow.pyfunc.load_model(f"models:/{name}@champion")
        u = pd.DataFrame({"alpha": [0.0, 0.1], "mach": [0.7, 0.65]})
        predicted = champion.predict(u)
    finally:
        mlflow.set_tracking_uri(None)
    assert list(predicted.columns) == ["lift", "drag"]
    np.testing.assert_array_equal(predicted, learned(u[["mach", "alpha"]].to_numpy()))
    card = MlflowClient(uri).get_model_version_by_alias(name, "champion").description
    fewest = "Of all networks whose validation nmse is at most 1e-06, it takes the fewest operations"
    for words in (fewest, "2 outputs of 2 inputs", "0.6 to 0.8", "2e-07", f"models:/{name}@champion"):
        assert words in card
