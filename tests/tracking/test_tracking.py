import logging
import os
import shutil
import signal
import socket
import sqlite3
import sys
from contextlib import closing
from multiprocessing import get_context
from pathlib import Path

import pytest
from mlflow import MlflowClient
from sqlalchemy import Engine, event

from flexsurr.training import tracking
from flexsurr.training.tracking import (
    RUN_KEY,
    Store,
    create_store,
    database,
    end_sweep,
    read_store,
    store_uri,
    tracked,
    write_store,
)

PARENT = "mlflow.parentRunId"


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Store:
    """A real store; creating one takes seconds, so the tests of this file share it."""
    folder = tmp_path_factory.mktemp("mlflow")
    return create_store(store_uri(None, folder), folder, ["cantilever", "wing"])


def run_of(store: Store, key: str, study: str = "cantilever"):
    found = MlflowClient(store.uri).search_runs([store.experiments[study]], f"tags.`{RUN_KEY}` = '{key}'")
    assert len(found) == 1
    return found[0]


def train_in_another_process(store: Store, key: str) -> None:
    with tracked(store, "wing", key, {}) as trial:
        for epoch in range(50):
            trial.epoch(epoch, 1.0 / (1 + epoch), 1.0)


def test_a_trial_is_a_child_with_parameters_losses_figures_and_files(made, tmp_path):
    weights = tmp_path / "weights.npz"
    weights.write_bytes(b"weights")
    with tracked(made, "cantilever", "hnn-1", {"hidden": [16], "degree": None}) as trial:
        for epoch in range(1500):
            trial.epoch(epoch, 1.0 / (1 + epoch), 2.0 / (1 + epoch))
        trial.keep({"train_nmse": 1e-9, "diverged": 0, "reason": ""}, {"dataset_sha256": "abc"}, [weights])
    run = run_of(made, "hnn-1")
    assert run.info.status == "FINISHED"
    assert run.data.tags[PARENT] == made.parents["cantilever"]
    assert run.data.tags["dataset_sha256"] == "abc"
    assert run.data.params == {"hidden": "[16]"}
    assert run.data.metrics["train_nmse"] == 1e-9
    client = MlflowClient(made.uri)
    history = client.get_metric_history(run.info.run_id, "validation_loss")
    assert [(m.step, m.value) for m in history] == [(e, 2.0 / (1 + e)) for e in range(1500)]
    assert [f.path for f in client.list_artifacts(run.info.run_id)] == ["weights.npz"]
    assert Path(database(Path(made.uri.removeprefix("sqlite:///")).parent)).is_file()
    assert Path(client.download_artifacts(run.info.run_id, "weights.npz")).read_bytes() == b"weights"


def test_a_failed_trial_says_why(made):
    with tracked(made, "cantilever", "hnn-2", {}) as trial:
        trial.status, trial.reason = "failed", "the loss left the finite numbers at epoch 3"
    run = run_of(made, "hnn-2")
    assert run.info.status == "FAILED"
    assert run.data.tags["reason"] == "the loss left the finite numbers at epoch 3"


def test_a_trial_stopped_as_hopeless_has_finished_and_says_why(made):
    with tracked(made, "cantilever", "hnn-4", {}) as trial:
        trial.status, trial.reason = "stopped", "the best validation nmse was 0.9 after 5 epochs, above 0.5"
    run = run_of(made, "hnn-4")
    assert run.info.status == "FINISHED"
    assert run.data.tags["reason"].endswith("above 0.5")


def test_an_exception_passes_and_is_recorded(made):
    with pytest.raises(RuntimeError, match="boom"), tracked(made, "cantilever", "hnn-3", {}):
        raise RuntimeError("boom")
    run = run_of(made, "hnn-3")
    assert (run.info.status, run.data.tags["reason"]) == ("FAILED", "RuntimeError: boom")


@pytest.mark.parametrize("stop", [SystemExit(143), KeyboardInterrupt()])
def test_a_job_told_to_stop_ends_its_run(made, stop):
    key = f"hnn-{type(stop).__name__}"
    with pytest.raises(type(stop)), tracked(made, "cantilever", key, {}):
        raise stop
    assert run_of(made, key).info.status == "KILLED"


def tell_everything(store, key, before_the_end=lambda: None):
    with tracked(store, "cantilever", key, {}) as trial:
        trial.epoch(1, 1.0, 2.0)
        trial.send()
        before_the_end()
        trial.keep({"train_nmse": 1.0}, {}, [])


@pytest.mark.parametrize("moment", ["_start", "_send", "_keep", "_end"])
def test_a_signal_in_the_middle_of_writing_waits(made, monkeypatch, moment):
    """At its worst moment: what was begun is finished, and the signal is heeded right after."""
    whole = getattr(tracking, moment)

    def interrupted(*arguments):
        os.kill(os.getpid(), signal.SIGTERM)
        result = whole(*arguments)
        os.kill(os.getpid(), signal.SIGTERM)
        return result

    monkeypatch.setattr(tracking, moment, interrupted)
    before = signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(143))
    try:
        with pytest.raises(SystemExit):
            tell_everything(made, f"hnn{moment}")
    finally:
        signal.signal(signal.SIGTERM, before)
    ended = {"_start": "KILLED", "_send": "KILLED", "_keep": "KILLED", "_end": "FINISHED"}
    assert run_of(made, f"hnn{moment}").info.status == ended[moment]


def test_a_signal_within_a_transaction_waits_for_its_end(made):
    """One that broke into it could leave the database locked, and the run RUNNING."""
    statements: list[str] = []

    def interrupting(connection, cursor, statement, parameters, context, executemany):
        if statement.startswith(("INSERT", "UPDATE")) and len(statements) < 3:
            statements.append(statement)
            os.kill(os.getpid(), signal.SIGTERM)

    before = signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(143))
    try:
        with pytest.raises(SystemExit):
            tell_everything(made, "hnn-8", lambda: event.listen(Engine, "after_cursor_execute", interrupting))
    finally:
        event.remove(Engine, "after_cursor_execute", interrupting)
        signal.signal(signal.SIGTERM, before)
    assert statements != []
    assert run_of(made, "hnn-8").info.status == "KILLED"
    assert run_of(made, "hnn-8").data.metrics["train_nmse"] == 1.0


def test_a_run_left_running_is_removed_when_its_job_starts_again(made):
    abandoned = tracked(made, "cantilever", "hnn-5", {})
    abandoned.__enter__()
    first = run_of(made, "hnn-5").info.run_id
    with tracked(made, "cantilever", "hnn-5", {}):
        pass
    second = run_of(made, "hnn-5")
    assert second.info.status == "FINISHED"
    assert second.info.run_id != first
    assert MlflowClient(made.uri).get_run(first).info.lifecycle_stage == "deleted"


def test_the_end_of_the_sweep_leaves_nothing_running(made):
    abandoned = tracked(made, "cantilever", "hnn-6", {})
    abandoned.__enter__()
    with tracked(made, "cantilever", "hnn-7", {}):
        pass
    end_sweep(made, "cantilever", {"hnn-7": {"long_response_error_percent_worst": 0.5}})
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
    with caplog.at_level(logging.WARNING), tracked(gone, "wing", "hnn-8", {}) as trial:
        trial.epoch(0, 1.0, 1.0)
    assert "results are made without it" in caplog.text
    again = create_store(uri, tmp_path / "mlflow", ["cantilever", "wing"])
    assert "wing had been deleted on the page; it is restored" in caplog.text
    with tracked(again, "wing", "hnn-8", {}):
        pass
    assert run_of(again, "hnn-8", "wing").info.status == "FINISHED"


def test_artefacts_are_found_and_kept_where_the_folder_has_moved_to(made, tmp_path):
    weights = tmp_path / "weights.npz"
    weights.write_bytes(b"weights")
    with tracked(made, "cantilever", "hnn-9", {}) as trial:
        trial.keep({}, {}, [weights])
    old = Path(made.uri.removeprefix("sqlite:///")).parent
    uri = copied(made, tmp_path / "mlflow")
    shutil.copytree(old / "artifacts", tmp_path / "mlflow/artifacts")
    moved = create_store(uri, tmp_path / "mlflow", ["cantilever", "wing"])
    with tracked(moved, "cantilever", "hnn-10", {}) as trial:
        trial.keep({}, {}, [weights])
    client = MlflowClient(uri)
    for key in ("hnn-9", "hnn-10"):
        run = run_of(moved, key)
        assert run.info.artifact_uri.startswith((tmp_path / "mlflow/artifacts/cantilever").as_uri())
        assert [file.path for file in client.list_artifacts(run.info.run_id)] == ["weights.npz"]


def test_a_database_that_may_only_be_read_is_a_warning(made, tmp_path, caplog):
    uri = copied(made, tmp_path / "mlflow")
    refuse = "BEGIN SELECT RAISE(ABORT, 'attempt to write a readonly database'); END"
    with closing(sqlite3.connect(database(tmp_path / "mlflow"))) as connection, connection:
        for event in ("INSERT", "UPDATE"):
            connection.execute(f"CREATE TRIGGER no_{event} BEFORE {event} ON runs {refuse}")
    store = Store(uri, made.experiments, made.parents)
    with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-11", {}) as trial:
        trial.epoch(0, 1.0, 1.0)
    end_sweep(store, "cantilever", {})
    assert "readonly database" in caplog.text
    assert "results are made without it" in caplog.text


def test_a_locked_database_is_a_warning(made, tmp_path, caplog):
    uri = copied(made, tmp_path / "mlflow")
    store = Store(uri, made.experiments, made.parents)
    with closing(sqlite3.connect(database(tmp_path / "mlflow"), isolation_level=None)) as connection:
        connection.execute("BEGIN EXCLUSIVE")
        with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-12", {}) as trial:
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
        with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-1", {}) as trial:
            for epoch in range(5):
                trial.epoch(epoch, 1.0, 1.0)
                trial.send()
            trial.keep({"train_nmse": 1.0}, {}, [])
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
        with tracked(store, "cantilever", "hnn-1", {}) as trial:
            trial.epoch(0, 1.0, 1.0)
    assert "results are made without it" in caplog.text


def test_creating_the_store_again_changes_nothing(made):
    folder = database(Path(made.uri.removeprefix("sqlite:///")).parent).parent
    assert create_store(made.uri, folder, ["cantilever", "wing"]) == made


def test_many_processes_write_at_once(made):
    context = get_context("spawn")
    keys = [f"wing-{number}" for number in range(3)]
    workers = [context.Process(target=train_in_another_process, args=(made, key)) for key in keys]
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
    with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-1", {}) as trial:
        trial.epoch(0, 1.0, 1.0)
        trial.keep({"train_nmse": 1.0}, {}, [])
    assert "mlflow.db is gone; results are made without it" in caplog.text
    assert list(tmp_path.iterdir()) == []


def test_a_ruined_database_is_a_warning(tmp_path, caplog):
    database(tmp_path).write_bytes(b"this is no database" * 100)
    store = Store(store_uri(None, tmp_path), {"cantilever": "1"}, {"cantilever": "x"})
    with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-1", {}) as trial:
        trial.epoch(0, 1.0, 1.0)
    assert "results are made without it" in caplog.text


def test_a_database_that_loses_its_tables_half_way_is_a_warning(tmp_path, caplog):
    store = create_store(store_uri(None, tmp_path), tmp_path, ["cantilever"])
    with caplog.at_level(logging.WARNING), tracked(store, "cantilever", "hnn-1", {}) as trial:
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
    with tracked(None, "cantilever", "hnn-1", {}) as trial:
        trial.epoch(0, 1.0, 1.0)
        trial.keep({"train_nmse": 1.0}, {}, [])
    end_sweep(None, "cantilever", {})
