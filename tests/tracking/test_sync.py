"""`flexsurr track`: what the page lacks, it gets from the files, once."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from mlflow import MlflowClient
from run_folders import described, write_run, write_scores

from flexsurr.cli.tracking import store, track
from flexsurr.config.errors import ConfigurationError
from flexsurr.storage import StorageError
from flexsurr.tracking.description import RUN_KEY
from flexsurr.tracking.run_files import UNLOGGED
from flexsurr.tracking.store import database, keep_artefacts_beside, read_store, store_uri
from flexsurr.tracking.trial import tracked

AWAY = "http://127.0.0.1:9"


@pytest.fixture(scope="module")
def empty(tmp_path_factory) -> Path:
    """Results with a store in which there is nothing yet."""
    results = tmp_path_factory.mktemp("empty")
    store({"uri": None, "studies": ["cantilever"]}, results / "mlflow/store.json")
    return results


@pytest.fixture
def results(empty, tmp_path) -> Path:
    """Results with a store of their own, in which there is nothing yet."""
    return copied(empty, tmp_path / "results")


def copied(results: Path, to: Path) -> Path:
    """A copy whose artefacts lie beside it, as Snakemake has it from its start on."""
    shutil.copytree(results, to)
    keep_artefacts_beside(to / "mlflow")
    return to


def train(results: Path, key: str, **fit) -> Path:
    """A run that tells the page of itself as it trains."""
    folder = write_run(results / "runs", key, **fit)
    with tracked(read_store(results / "mlflow/store.json"), described(key), folder) as trial:
        for epoch in range(3):
            trial.epoch(epoch, 1.0 / (1 + epoch), 2.0 / (1 + epoch))
        trial.keep()
        trial.status, trial.reason = fit.get("status", "finished"), fit.get("reason", "")
    return folder


def page(results: Path) -> tuple[MlflowClient, list]:
    """A client, and the runs of the cantilever."""
    client = MlflowClient(store_uri(None, results / "mlflow"))
    experiment = client.get_experiment_by_name("cantilever").experiment_id
    return client, client.search_runs([experiment])


def content(results: Path) -> dict[str, tuple]:
    """What the page has of each trial, but for times and what the machine did."""
    client, runs = page(results)
    found = {}
    for run in runs:
        if RUN_KEY in run.data.tags:
            losses = client.get_metric_history(run.info.run_id, "train_loss")
            metrics = {name: value for name, value in run.data.metrics.items() if "system/" not in name}
            found[run.data.tags[RUN_KEY]] = (
                run.info.status,
                {name: tag for name, tag in run.data.tags.items() if name != "mlflow.parentRunId"},
                run.data.params,
                metrics,
                sorted((metric.step, metric.value) for metric in losses),
                sorted(file.path for file in client.list_artifacts(run.info.run_id)),
                [(each.dataset.name, each.dataset.digest) for each in run.inputs.dataset_inputs],
            )
    return found


def test_runs_logged_from_their_files_are_as_if_they_had_told_of_themselves(results, tmp_path, empty):
    elsewhere = copied(empty, tmp_path / "elsewhere")
    for key, fit in (("hnn-1", {}), ("hnn-2", {"status": "failed", "reason": "the loss is nan"})):
        write_scores(train(results, key, **fit), long_response_error_percent_worst=0.5)
    track(results, sync=False, uri=None)
    shutil.copytree(results / "runs", elsewhere / "runs")
    track(elsewhere, sync=True, uri=None)
    assert content(elsewhere) == content(results)
    assert content(results)["hnn-1"][3]["long_response_error_percent_worst"] == 0.5
    assert content(results)["hnn-2"][0] == "FAILED"


@pytest.mark.parametrize("sync", [False, True])
def test_a_folder_without_results_is_refused_and_not_made(tmp_path, sync):
    with pytest.raises(StorageError, match=r"--results: .*nowhere is not allowed; allowed: a folder"):
        track(tmp_path / "nowhere", sync=sync, uri=None)
    assert list(tmp_path.iterdir()) == []


def test_an_address_is_checked_as_that_of_the_configuration_is(tmp_path):
    (tmp_path / "runs").mkdir()
    with pytest.raises(ConfigurationError, match="--uri: 'localhost:5000' is no address of a store; allowed"):
        track(tmp_path, sync=False, uri="localhost:5000")
    assert [path.name for path in tmp_path.iterdir()] == ["runs"]


def test_what_is_there_is_not_logged_again(results):
    train(results, "hnn-1")
    write_run(results / "runs", "hnn-2")
    track(results, sync=True, uri=None)
    before = [run.to_dictionary() for run in page(results)[1]]
    track(results, sync=True, uri=None)
    assert [run.to_dictionary() for run in page(results)[1]] == before


def test_a_run_trained_anew_is_logged_beside_the_old_one(results):
    write_run(results / "runs", "hnn-1")
    track(results, sync=True, uri=None)
    write_run(results / "runs", "hnn-1", train_nmse=0.5)
    track(results, sync=True, uri=None)
    found = [run.data.metrics.get("train_nmse") for run in page(results)[1] if RUN_KEY in run.data.tags]
    assert sorted(found) == [1e-9, 0.5]


def test_a_store_away_while_training_is_said_and_made_up_for(results, capsys):
    store({"uri": AWAY, "studies": ["cantilever"]}, results / "mlflow/store.json")
    folder = train(results, "hnn-1")
    assert (folder / UNLOGGED).exists()
    track(results, sync=False, uri=None)
    said = "cantilever: not logged: 1 run, scores, figures and champions; flexsurr track --sync logs them"
    assert said in capsys.readouterr().err
    with pytest.raises(StorageError, match="not all of it is on the page"):
        track(results, sync=True, uri=None)
    assert capsys.readouterr().err.endswith(said.partition(";")[0] + "\n")
    track(results, sync=True, uri=store_uri(None, results / "mlflow"))
    assert not (folder / UNLOGGED).exists()
    assert set(content(results)) == {"hnn-1"}
    capsys.readouterr()
    track(results, sync=False, uri=None)
    assert "not logged" not in capsys.readouterr().err


def test_a_deleted_database_comes_back_from_the_files(results):
    train(results, "hnn-1")
    before = content(results)
    database(results / "mlflow").unlink()
    # in a process of its own, for MLflow remembers what a database has
    command = [sys.executable, "-m", "flexsurr", "track", "--sync", "--results", str(results)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert "cantilever: 1 run logged from their files" in done.stderr
    assert content(results) == before


def test_figures_are_artefacts_of_the_parent_run(results):
    train(results, "hnn-1")
    figures = results / "figures/cantilever"
    figures.mkdir(parents=True)
    (figures / "figure_03.png").write_bytes(b"one")
    for picture in (b"one", b"another"):
        (figures / "figure_03.png").write_bytes(picture)
        track(results, sync=False, uri=None)
        client, _ = page(results)
        parent = read_store(results / "mlflow/store.json").parents["cantilever"]
        assert [file.path for file in client.list_artifacts(parent, "figures")] == ["figures/figure_03.png"]
        assert Path(client.download_artifacts(parent, "figures/figure_03.png")).read_bytes() == picture


def test_a_damaged_run_is_a_warning_and_the_others_are_logged(results, caplog):
    write_run(results / "runs", "hnn-1")
    (write_run(results / "runs", "hnn-2") / "fit.json").write_text("{")
    track(results, sync=True, uri=None)
    assert "hnn-2/fit.json: damaged" in caplog.text
    assert set(content(results)) == {"hnn-1"}


def test_a_study_that_the_store_does_not_know_waits_for_a_sync(results):
    write_run(results / "runs", "hnn-1", "wing")
    track(results, sync=False, uri=None)
    assert "wing" not in read_store(results / "mlflow/store.json").experiments
    track(results, sync=True, uri=None)
    assert set(read_store(results / "mlflow/store.json").experiments) == {"cantilever", "wing"}


def test_a_selection_without_its_run_registers_nothing(results, caplog):
    train(results, "hnn-1")
    (results / "selected").mkdir()
    entry = {"run_id": "hnn-gone", "long_response_error_percent_worst": 1.0}
    (results / "selected/cantilever.json").write_text(
        json.dumps({"hamiltonian": {"hnn": entry, "chosen": "hnn"}})
    )
    track(results, sync=False, uri=None)
    assert "hnn-gone/weights.npz: cannot be read" in caplog.text
