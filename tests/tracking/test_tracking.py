import logging
import os
import shutil
import signal
import socket
import sqlite3
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import pytest
from mlflow import MlflowClient
from run_folders import COMMIT, SHA256, described, write_run, write_scores
from sqlalchemy import Engine, event

from flexsurr.tracking import trial as trials
from flexsurr.tracking.description import RUN_KEY
from flexsurr.tracking.page import Page
from flexsurr.tracking.recording import end_sweeps, record
from flexsurr.tracking.run_files import UNLOGGED, RunFiles
from flexsurr.tracking.store import Store, create_store, database, read_store, store_uri, write_store
from flexsurr.tracking.trial import TrackedRun

PARENT = "mlflow.parentRunId"
SYSTEM = "system/"


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Store:
    """A real store; creating one takes seconds, so the tests of this file share it."""
    folder = tmp_path_factory.mktemp("mlflow")
    return create_store(store_uri(None, folder), folder, ["cantilever", "wing"])


def run_of(store: Store, key: str, study: str = "cantilever"):
    found = MlflowClient(store.uri).search_runs([store.experiments[study]], f"tags.`{RUN_KEY}` = '{key}'")
    assert len(found) == 1
    return found[0]


@contextmanager
def tracked(store: Store | None, study: str, key: str, runs: Path) -> Iterator[TrackedRun]:
    """A trial whose files are all there from the start."""
    folder = write_run(runs, key, study)
    with trials.tracked(store, described(key, study), folder) as trial:
        yield trial


def train_in_another_process(store: Store, key: str, runs: Path) -> None:
    with tracked(store, "wing", key, runs) as trial:
        for epoch in range(50):
            trial.epoch(epoch, 1.0 / (1 + epoch), 1.0)
        trial.keep()


def test_a_trial_is_a_child_with_parameters_losses_figures_and_files(made, tmp_path):
    with tracked(made, "cantilever", "hnn-1", tmp_path) as trial:
        for epoch in range(1500):
            trial.epoch(epoch, 1.0 / (1 + epoch), 2.0 / (1 + epoch))
        trial.keep()
    run = run_of(made, "hnn-1")
    assert run.info.status == "FINISHED"
    assert run.data.tags[PARENT] == made.parents["cantilever"]
    client = MlflowClient(made.uri)
    history = client.get_metric_history(run.info.run_id, "validation_loss")
    assert [(m.step, m.value) for m in history] == [(e, 2.0 / (1 + e)) for e in range(1500)]
    assert sorted(file.path for file in client.list_artifacts(run.info.run_id)) == [
        "history.parquet",
        "parameters.json",
        "weights.npz",
    ]
    assert Path(client.download_artifacts(run.info.run_id, "weights.npz")).read_bytes() == b"weights"
    assert not (tmp_path / "hnn-1" / UNLOGGED).exists()


def test_a_metric_is_what_was_measured_and_a_setting_is_a_parameter(made, tmp_path):
    with tracked(made, "cantilever", "hnn-20", tmp_path) as trial:
        trial.epoch(0, 1.0, 2.0)
        trial.keep()
    data = run_of(made, "hnn-20").data
    measured = {name for name in data.metrics if not name.startswith(SYSTEM)}
    assert measured == {"train_loss", "validation_loss", "wall_s", "train_nmse"}
    settings = {"architecture": "hnn", "seed": "3", "epochs": "40", "variant": "hamiltonian"}
    assert data.params == settings | {"parameter_count": "130"}


def test_a_run_has_tags_its_dataset_and_what_it_took_of_the_machine(made, tmp_path):
    with tracked(made, "cantilever", "hnn-21", tmp_path) as trial:
        trial.epoch(0, 1.0, 2.0)
        trial.keep()
    run = run_of(made, "hnn-21")
    wanted = {"study": "cantilever", "variant": "hamiltonian", "architecture": "hnn"}
    wanted |= {"dataset_sha256": SHA256, "mlflow.source.git.commit": COMMIT}
    assert wanted.items() <= run.data.tags.items()
    (dataset,) = run.inputs.dataset_inputs
    assert (dataset.dataset.name, dataset.dataset.digest) == ("cantilever/hamiltonian", SHA256[:32])
    assert SHA256 in dataset.dataset.profile
    assert [(tag.key, tag.value) for tag in dataset.tags] == [("mlflow.data.context", "training")]
    assert 0.0 <= run.data.metrics["system/cpu_utilization_percentage"] <= 100.0
    assert run.data.metrics["system/process_memory_megabytes"] > 10.0


def test_an_experiment_is_of_the_kind_on_whose_runs_the_page_opens(made):
    client = MlflowClient(made.uri)
    for experiment in made.experiments.values():
        assert client.get_experiment(experiment).tags["mlflow.experimentKind"] == "custom_model_development"


def test_a_failed_trial_says_why(made, tmp_path):
    with tracked(made, "cantilever", "hnn-2", tmp_path) as trial:
        trial.status, trial.reason = "failed", "the loss left the finite numbers at epoch 3"
    run = run_of(made, "hnn-2")
    assert run.info.status == "FAILED"
    assert run.data.tags["reason"] == "the loss left the finite numbers at epoch 3"


def test_a_trial_stopped_as_hopeless_has_finished_and_says_why(made, tmp_path):
    with tracked(made, "cantilever", "hnn-4", tmp_path) as trial:
        trial.status, trial.reason = "stopped", "the best validation nmse was 0.9 after 5 epochs, above 0.5"
    run = run_of(made, "hnn-4")
    assert run.info.status == "FINISHED"
    assert run.data.tags["reason"].endswith("above 0.5")


def test_an_exception_passes_and_is_recorded(made, tmp_path):
    with pytest.raises(RuntimeError, match="boom"), tracked(made, "cantilever", "hnn-3", tmp_path):
        raise RuntimeError("boom")
    run = run_of(made, "hnn-3")
    assert (run.info.status, run.data.tags["reason"]) == ("FAILED", "RuntimeError: boom")


@pytest.mark.parametrize("stop", [SystemExit(143), KeyboardInterrupt()])
def test_a_job_told_to_stop_ends_its_run(made, tmp_path, stop):
    key = f"hnn-{type(stop).__name__}"
    with pytest.raises(type(stop)), tracked(made, "cantilever", key, tmp_path):
        raise stop
    assert run_of(made, key).info.status == "KILLED"


def tell_everything(store, key, runs, before_the_end=lambda: None):
    with tracked(store, "cantilever", key, runs) as trial:
        trial.epoch(1, 1.0, 2.0)
        trial.send()
        before_the_end()
        trial.keep()


@pytest.mark.parametrize("moment", ["start", "send", "keep_files", "end"])
def test_a_signal_in_the_middle_of_writing_waits(made, tmp_path, monkeypatch, moment):
    """At its worst moment: what was begun is finished, and the signal is heeded right after."""
    whole = getattr(trials, moment)

    def interrupted(*arguments):
        os.kill(os.getpid(), signal.SIGTERM)
        result = whole(*arguments)
        os.kill(os.getpid(), signal.SIGTERM)
        return result

    monkeypatch.setattr(trials, moment, interrupted)
    before = signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(143))
    try:
        with pytest.raises(SystemExit):
            tell_everything(made, f"hnn-{moment}", tmp_path)
    finally:
        signal.signal(signal.SIGTERM, before)
    assert run_of(made, f"hnn-{moment}").info.status == ("FINISHED" if moment == "end" else "KILLED")


def test_a_signal_within_a_transaction_waits_for_its_end(made, tmp_path):
    """One that broke into it could leave the database locked, and the run RUNNING."""
    statements: list[str] = []

    def interrupting(connection, cursor, statement, parameters, context, executemany):
        if statement.startswith(("INSERT", "UPDATE")) and len(statements) < 3:
            statements.append(statement)
            os.kill(os.getpid(), signal.SIGTERM)

    listen = partial(event.listen, Engine, "after_cursor_execute", interrupting)
    before = signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(143))
    try:
        with pytest.raises(SystemExit):
            tell_everything(made, "hnn-8", tmp_path, listen)
    finally:
        event.remove(Engine, "after_cursor_execute", interrupting)
        signal.signal(signal.SIGTERM, before)
    assert statements != []
    assert run_of(made, "hnn-8").info.status == "KILLED"
    assert run_of(made, "hnn-8").data.metrics["train_nmse"] == 1e-9


def test_a_run_left_running_is_removed_when_its_job_starts_again(made, tmp_path):
    abandoned = tracked(made, "cantilever", "hnn-5", tmp_path)
    abandoned.__enter__()
    first = run_of(made, "hnn-5").info.run_id
    with tracked(made, "cantilever", "hnn-5", tmp_path):
        pass
    second = run_of(made, "hnn-5")
    assert second.info.status == "FINISHED"
    assert second.info.run_id != first
    assert MlflowClient(made.uri).get_run(first).info.lifecycle_stage == "deleted"


def test_the_end_of_the_sweep_leaves_nothing_running(made, tmp_path):
    abandoned = tracked(made, "cantilever", "hnn-6", tmp_path)
    abandoned.__enter__()
    with tracked(made, "cantilever", "hnn-7", tmp_path) as trial:
        trial.keep()
    write_scores(tmp_path / "hnn-7", long_response_error_percent_worst=0.5)
    runs = [RunFiles(tmp_path / key) for key in ("hnn-6", "hnn-7")]
    page = Page(made)
    record(page, "cantilever", runs, [])
    end_sweeps(page, "cantilever", runs)
    client = MlflowClient(made.uri)
    assert run_of(made, "hnn-6").info.status == "KILLED"
    assert run_of(made, "hnn-7").data.metrics["long_response_error_percent_worst"] == 0.5
    assert client.get_run(made.parents["cantilever"]).info.status == "FINISHED"
    assert client.search_runs([made.experiments["cantilever"]], "attributes.status = 'RUNNING'") == []


def test_a_store_is_found_again_where_its_folder_has_moved_to(tmp_path):
    old, new = tmp_path / "old", tmp_path / "new"
    old.mkdir()
    write_store(old / "store.json", Store(store_uri(None, old), {"cantilever": "1"}, {"cantilever": "x"}))
    old.rename(new)
    assert read_store(new / "store.json").uri == store_uri(None, new)
    server = Store("http://127.0.0.1:5000", {}, {})
    write_store(new / "store.json", server)
    assert read_store(new / "store.json") == server


def copied(store: Store, folder: Path) -> str:
    """The address of a copy of the store's database in `folder`, as a copied or moved folder has it."""
    folder.mkdir()
    shutil.copy(store.uri.removeprefix("sqlite:///"), database(folder))
    return store_uri(None, folder)


def test_an_experiment_deleted_on_the_page_is_restored(made, tmp_path, caplog):
    uri = copied(made, tmp_path / "mlflow")
    MlflowClient(uri).delete_experiment(made.experiments["wing"])
    gone = Store(uri, made.experiments, made.parents)
    with caplog.at_level(logging.WARNING), tracked(gone, "wing", "hnn-8", tmp_path) as trial:
        trial.epoch(0, 1.0, 1.0)
    assert "results are made without it" in caplog.text
    again = create_store(uri, tmp_path / "mlflow", ["cantilever", "wing"])
    assert "wing had been deleted on the page; it is restored" in caplog.text
    with tracked(again, "wing", "hnn-8", tmp_path):
        pass
    assert run_of(again, "hnn-8", "wing").info.status == "FINISHED"


def test_artefacts_are_found_and_kept_where_the_folder_has_moved_to(made, tmp_path):
    with tracked(made, "cantilever", "hnn-9", tmp_path) as trial:
        trial.keep()
    old = Path(made.uri.removeprefix("sqlite:///")).parent
    uri = copied(made, tmp_path / "mlflow")
    shutil.copytree(old / "artifacts", tmp_path / "mlflow/artifacts")
    moved = create_store(uri, tmp_path / "mlflow", ["cantilever", "wing"])
    with tracked(moved, "cantilever", "hnn-10", tmp_path) as trial:
        trial.keep()
    client = MlflowClient(uri)
    for key in ("hnn-9", "hnn-10"):
        run = run_of(moved, key)
        assert run.info.artifact_uri.startswith((tmp_path / "mlflow/artifacts/cantilever").as_uri())
        assert "weights.npz" in [file.path for file in client.list_artifacts(run.info.run_id)]


def test_a_database_that_may_only_be_read_is_a_warning(made, tmp_path, caplog):
    uri = copied(made, tmp_path / "mlflow")
    refuse = "BEGIN SELECT RAISE(ABORT, 'attempt to write a readonly database'); END"
    with closing(sqlite3.connect(database(tmp_path / "mlflow"))) as connection, connection:
        for event in ("INSERT", "UPDATE"):
            connection.execute(f"CREATE TRIGGER no_{event} BEFORE {event} ON runs {refuse}")
    store = Store(uri, made.experiments, made.parents)
    with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-11", tmp_path) as trial:
        trial.epoch(0, 1.0, 1.0)
    end_sweeps(Page(store), "cantilever", [])
    assert "readonly database" in caplog.text
    assert "results are made without it" in caplog.text


def test_a_locked_database_is_a_warning(made, tmp_path, caplog):
    uri = copied(made, tmp_path / "mlflow")
    store = Store(uri, made.experiments, made.parents)
    with closing(sqlite3.connect(database(tmp_path / "mlflow"), isolation_level=None)) as connection:
        connection.execute("BEGIN EXCLUSIVE")
        with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-12", tmp_path) as trial:
            trial.epoch(0, 1.0, 1.0)
        connection.execute("ROLLBACK")
    assert "results are made without it" in caplog.text


def test_a_store_of_another_schema_is_one_warning(made, tmp_path, caplog):
    uri = copied(made, tmp_path / "mlflow")
    with closing(sqlite3.connect(database(tmp_path / "mlflow"))) as connection, connection:
        connection.execute("UPDATE alembic_version SET version_num = 'another'")
    with caplog.at_level(logging.WARNING):
        assert create_store(uri, tmp_path / "mlflow", ["cantilever"]) is None
    (record,) = caplog.records
    assert "another" in record.getMessage()
    assert len(record.getMessage().splitlines()) == 1


def test_a_server_that_never_answers_is_asked_once(tmp_path, monkeypatch, caplog):
    monkeypatch.setenv("MLFLOW_HTTP_REQUEST_TIMEOUT", "1")
    monkeypatch.setenv("MLFLOW_HTTP_REQUEST_MAX_RETRIES", "0")
    with socket.create_server(("127.0.0.1", 0)) as server:
        uri = f"http://user:secret@127.0.0.1:{server.getsockname()[1]}"
        store = Store(uri, {"cantilever": "1"}, {"cantilever": "x"})
        with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-1", tmp_path) as trial:
            for epoch in range(5):
                trial.epoch(epoch, 1.0, 1.0)
                trial.send()
            trial.keep()
        server.setblocking(False)
        server.accept()[0].close()
        with pytest.raises(BlockingIOError):
            server.accept()
    assert caplog.text.count("results are made without it") == 1
    assert "secret" not in caplog.text


@pytest.mark.parametrize("content", ["{", "[]", '{"uri": 7}', '{"uri": 7, "experiments": 1, "parents": 2}'])
def test_a_damaged_address_of_the_store_is_a_warning(tmp_path, caplog, content):
    (tmp_path / "store.json").write_text(content)
    with caplog.at_level(logging.WARNING):
        store = read_store(tmp_path / "store.json")
        with tracked(store, "cantilever", "hnn-1", tmp_path) as trial:
            trial.epoch(0, 1.0, 1.0)
    assert "results are made without it" in caplog.text


def test_creating_the_store_again_changes_nothing(made):
    folder = database(Path(made.uri.removeprefix("sqlite:///")).parent).parent
    assert create_store(made.uri, folder, ["cantilever", "wing"]) == made


def test_four_processes_write_at_once(made, tmp_path):
    context = get_context("spawn")
    keys = [f"wing-{number}" for number in range(4)]
    workers = [context.Process(target=train_in_another_process, args=(made, key, tmp_path)) for key in keys]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join(120)
        assert worker.exitcode == 0
    for key in keys:
        run = run_of(made, key, "wing")
        assert (run.info.status, run.data.metrics["train_loss"]) == ("FINISHED", 1.0 / 50)


def test_a_deleted_database_is_a_warning_and_is_not_made_again(tmp_path, caplog):
    store = Store(store_uri(None, tmp_path), {"cantilever": "1"}, {"cantilever": "x"})
    with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-1", tmp_path / "runs") as trial:
        trial.epoch(0, 1.0, 1.0)
        trial.keep()
    assert "mlflow.db is gone; results are made without it" in caplog.text
    assert not database(tmp_path).exists()


def test_a_ruined_database_is_a_warning(tmp_path, caplog):
    database(tmp_path).write_bytes(b"this is no database" * 100)
    store = Store(store_uri(None, tmp_path), {"cantilever": "1"}, {"cantilever": "x"})
    with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-1", tmp_path) as trial:
        trial.epoch(0, 1.0, 1.0)
    assert "results are made without it" in caplog.text


def test_a_database_that_loses_its_tables_half_way_is_a_warning(tmp_path, caplog):
    store = create_store(store_uri(None, tmp_path), tmp_path, ["cantilever"])
    with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-1", tmp_path) as trial:
        with sqlite3.connect(database(tmp_path)) as connection:
            connection.execute("DROP TABLE metrics")
        connection.close()
        trial.epoch(0, 1.0, 1.0)
        trial.send()
    assert "results are made without it" in caplog.text


def test_a_store_out_of_reach_is_a_warning(tmp_path, caplog):
    with caplog.at_level(logging.WARNING):
        assert create_store("http://127.0.0.1:9", tmp_path, ["cantilever"]) is None
        assert read_store(tmp_path / "store.json") is None
    assert caplog.text.count("results are made without it") == 2
    with tracked(None, "cantilever", "hnn-1", tmp_path / "runs") as trial:
        trial.epoch(0, 1.0, 1.0)
        trial.keep()
    assert (tmp_path / "runs/hnn-1" / UNLOGGED).exists()
