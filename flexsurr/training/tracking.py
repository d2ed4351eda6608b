"""Training runs on the MLflow page: the only file that knows MLflow.

Files are the truth and MLflow is a view of them: whatever goes wrong here is a warning in the log, and
the results are made all the same. One experiment a study; in it one parent run for the sweeps of the
study, of which each trial is a child.
"""

import json
import logging
import math
import os
import re
import signal
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

# Before the import. MLflow reports its use to its makers otherwise, and waits minutes for a dead server.
os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")
os.environ.setdefault("MLFLOW_HTTP_REQUEST_MAX_RETRIES", "1")
os.environ.setdefault("MLFLOW_HTTP_REQUEST_TIMEOUT", "5")

from mlflow import MlflowClient
from mlflow.entities import LifecycleStage, Metric, Param, Run, RunTag
from mlflow.utils.mlflow_tags import MLFLOW_PARENT_RUN_ID, MLFLOW_RUN_NAME

from flexsurr.storage import write_json

log = logging.getLogger(__name__)
logging.getLogger("urllib3").setLevel(logging.ERROR)  # a server that is away is our own warning

RUN_KEY = "flexsurr.run_id"  # the tag by which a trial is found again
SWEEP = "flexsurr.sweep"  # marks the parent run of a study's sweeps
REASON = "reason"
BATCH = 1000  # MLflow takes no more metrics at once
LONGEST_WAIT_S = 10.0  # between batches, so that a person can watch
LONGEST_PARAMETER = 500
LONGEST_REASON = 300  # of a warning's
PLACES = {"experiments": "artifact_location", "runs": "artifact_uri", "logged_models": "artifact_location"}


@dataclass(frozen=True)
class Store:
    """Where runs are recorded; of each study the experiment and the parent run of its sweeps."""

    uri: str
    experiments: Mapping[str, str]
    parents: Mapping[str, str]


@dataclass
class Trial:
    """What a running trial tells the page. `status` and `reason` become those of its run at its end."""

    status: str = "finished"
    reason: str = ""
    _report: Callable[[Sequence[Metric]], None] | None = None
    _keep: Callable[[Mapping[str, Any], Mapping[str, str], Sequence[Path]], None] | None = None
    _waiting: list[Metric] = field(default_factory=list)
    _last_sent_s: float = field(default_factory=time.monotonic)

    def epoch(self, epoch: int, train_loss: float, validation_loss: float) -> None:
        """Losses of one epoch, sent with those of others in batches."""
        now = int(time.time() * 1000)
        self._waiting.append(Metric("train_loss", train_loss, now, epoch))
        self._waiting.append(Metric("validation_loss", validation_loss, now, epoch))
        if len(self._waiting) >= BATCH - 1 or time.monotonic() - self._last_sent_s > LONGEST_WAIT_S:
            self.send()

    def send(self) -> None:
        """Send the losses that wait."""
        waiting, self._waiting = self._waiting, []
        self._last_sent_s = time.monotonic()
        if self._report is not None and waiting:
            self._report(waiting)

    def keep(self, metrics: Mapping[str, Any], tags: Mapping[str, str], files: Sequence[Path]) -> None:
        """Final figures (those that are numbers), tags, and files kept as artefacts."""
        if self._keep is not None:
            self._keep(metrics, tags, files)


def store_uri(uri: str | None, folder: Path) -> str:
    """`uri`, or where none is given the absolute one of an SQLite database in `folder`."""
    return uri or f"sqlite:///{database(folder)}"


def database(folder: Path) -> Path:
    """The SQLite database of a store that lives in `folder`."""
    return folder.absolute() / "mlflow.db"


def write_store(path: Path, store: Store) -> None:
    """Write how to reach `store`; a database in the folder of `path` without its place, which may move."""
    is_beside = store.uri == store_uri(None, path.parent)
    write_json(path, {**asdict(store), "uri": None if is_beside else store.uri})


def read_store(path: Path) -> Store | None:
    """The store that `write_store` wrote to `path`; None, and a warning, where there is none to be read."""
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
        store = Store(**{**values, "uri": store_uri(values["uri"], path.parent)})
        if not isinstance(store.uri, str):
            raise TypeError(f"the address {store.uri!r}")
        return store
    except (OSError, ValueError, TypeError, KeyError) as error:
        _warn(f"{path}: no store", error)
        return None


def _warn(what: str, error: Exception) -> None:
    reason = " ".join(f"{type(error).__name__}: {error}".split())[:LONGEST_REASON]
    without_secrets = re.sub(r"://[^/@ ]*@", "://…@", f"{what} ({reason})")
    log.warning("tracking: %s; results are made without it", without_secrets)


def create_store(uri: str, folder: Path, studies: Sequence[str]) -> Store | None:
    """Create the store, or what is missing in it; two processes must not do this at once.

    Artefacts of a local store go into `folder`, and are looked for there where it has moved; a server keeps
    them as it likes. An experiment that was deleted on the page is restored. None, and a warning, where the
    store cannot be reached.
    """
    try:
        return _created(uri, folder, studies)
    # The server may be away, the database foreign or read-only: nothing of it is worth a result.
    except Exception as error:
        _warn(f"{uri} is out of reach", error)
        return None


def _created(uri: str, folder: Path, studies: Sequence[str]) -> Store:
    folder.mkdir(parents=True, exist_ok=True)
    client = MlflowClient(uri)
    local = uri.startswith("sqlite:")
    experiments, parents = {}, {}
    for study in studies:
        experiment = client.get_experiment_by_name(study)
        place = (folder.absolute() / "artifacts" / study).as_uri() if local else None
        if experiment is None:
            experiments[study] = client.create_experiment(study, artifact_location=place)
        else:
            experiments[study] = experiment.experiment_id
            if experiment.lifecycle_stage != LifecycleStage.ACTIVE:
                log.warning("tracking: the experiment %s had been deleted on the page; it is restored", study)
                client.restore_experiment(experiment.experiment_id)
            if uri == store_uri(None, folder) and place and experiment.artifact_location != place:
                _move_artefacts(database(folder), experiment.artifact_location, place)
        found = client.search_runs([experiments[study]], f"tags.`{SWEEP}` = '{study}'", max_results=1)
        if found:
            parents[study] = found[0].info.run_id
        else:
            run = client.create_run(
                experiments[study], tags={SWEEP: study, MLFLOW_RUN_NAME: f"sweeps of {study}"}
            )
            parents[study] = run.info.run_id
    return Store(uri, experiments, parents)


def _move_artefacts(path: Path, old: str, new: str) -> None:
    """Have the database look for artefacts below `new` instead of `old`; MLflow itself knows no such move."""
    with closing(sqlite3.connect(path)) as connection, connection:
        for table, column in PLACES.items():
            moved = f"UPDATE {table} SET {column} = ? || substr({column}, ?)"
            which = f"WHERE {column} = ? OR {column} LIKE ?"
            connection.execute(f"{moved} {which}", (new, len(old) + 1, old, f"{old}/%"))


@contextmanager
def tracked(store: Store | None, study: str, run_key: str, parameters: Mapping[str, Any]) -> Iterator[Trial]:
    """A child run of the study's sweeps for the time of the block; without a store, a trial untold.

    A run of the same key that an earlier, killed job left RUNNING is ended and deleted. The run ends
    FINISHED, also where it was stopped as hopeless, or FAILED where the trial says so or an exception
    passes, both with their reason as a tag, or KILLED where the process is told to stop.
    """
    trial = Trial()
    page = _Page(store)
    run = None
    status = "KILLED"
    try:
        with _signals_wait():
            run = page.attempt(lambda client, store: _start(client, store, study, run_key, parameters))
        if run is not None:
            trial._report = lambda metrics: page.attempt(lambda client, _: _send(client, run, metrics))
            trial._keep = lambda metrics, tags, files: page.attempt(
                lambda client, _: _keep(client, run, metrics, tags, files)
            )
        yield trial
        status = "FAILED" if trial.status == "failed" else "FINISHED"
    except Exception as error:
        status, trial.reason = "FAILED", f"{type(error).__name__}: {error}"
        raise
    finally:
        if run is not None:
            with _signals_wait():
                trial.send()
                page.insist(lambda client, _: _end(client, run, status, trial.reason))


@contextmanager
def _signals_wait() -> Iterator[None]:
    """Heed SIGTERM and Ctrl-C after the block: either in the middle would leave a run RUNNING for ever.

    Blocks may stand in one another; the outermost raises what came.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # signals are the main thread's, and only it may say what they do
        return
    came: list[int] = []
    before = {
        waiting: signal.signal(waiting, lambda number, frame: came.append(number))
        for waiting in (signal.SIGTERM, signal.SIGINT)
    }
    try:
        yield
    finally:
        for waiting, handler in before.items():
            signal.signal(waiting, handler)
        for number in came:
            signal.raise_signal(number)


def end_sweep(store: Store | None, study: str, final: Mapping[str, Mapping[str, Any]]) -> None:
    """Record the final figures of each run (key → metrics) and end the sweep's parent run.

    No trial of the study runs any more: whatever is left RUNNING was killed, and ends so.
    """
    page = _Page(store)

    def finish(client: MlflowClient, store: Store) -> None:
        runs = _all_runs(client, store.experiments[study])
        for run in runs:
            key = run.data.tags.get(RUN_KEY)
            if key is not None and run.info.status == "RUNNING":
                client.set_terminated(run.info.run_id, "KILLED")
            elif key in final:
                _keep(client, run.info.run_id, final[key], {}, [])
        _keep(client, store.parents[study], {"trials": len(final)}, {}, [])
        client.set_terminated(store.parents[study], "FINISHED")

    page.attempt(finish)


class _Page:
    """A client whose trouble is a warning: after it, the page is left alone until `insist`."""

    def __init__(self, store: Store | None) -> None:
        self._store = store
        self._client: MlflowClient | None = None
        self._connect()

    def attempt(self, action: Callable[[MlflowClient, Store], Any]) -> Any:
        """The result of `action`; None where there is no store, or trouble now, or has been.

        Signals wait: one that breaks into a write leaves the database locked until the process has ended.
        """
        if self._client is None or self._store is None:
            return None
        try:
            with _signals_wait():
                return action(self._client, self._store)
        # The database may be deleted, locked or full, the server away: nothing of it is worth a result.
        except Exception as error:
            _warn(f"trouble with {self._store.uri}", error)
            self._client = None
            return None

    def insist(self, action: Callable[[MlflowClient, Store], Any]) -> Any:
        """`attempt`, once more after trouble with a file, even this one; a server is not waited for twice."""
        result = self.attempt(action)
        if self._client is None and self._store is not None and self._store.uri.startswith("sqlite:"):
            self._connect()
            result = self.attempt(action)
        return result

    def _connect(self) -> None:
        if self._store is None:
            return
        uri = self._store.uri
        path = Path(uri.removeprefix("sqlite:///"))
        if uri.startswith("sqlite:///") and not path.is_file():
            # Creating it here could meet another process that does the same, and ruin it.
            log.warning("tracking: %s is gone; results are made without it", path)
            return
        try:
            self._client = MlflowClient(uri)
        except Exception as error:  # as above
            _warn(f"{uri} is out of reach", error)


def _start(
    client: MlflowClient, store: Store, study: str, run_key: str, parameters: Mapping[str, Any]
) -> str:
    experiment = store.experiments[study]
    for run in client.search_runs([experiment], f"tags.`{RUN_KEY}` = '{run_key}'"):
        if run.info.status == "RUNNING":
            client.set_terminated(run.info.run_id, "KILLED")
            client.delete_run(run.info.run_id)
    tags = {RUN_KEY: run_key, MLFLOW_RUN_NAME: run_key, MLFLOW_PARENT_RUN_ID: store.parents[study]}
    run_id: str = client.create_run(experiment, tags=tags).info.run_id
    shown = {name: str(value)[:LONGEST_PARAMETER] for name, value in parameters.items() if value is not None}
    client.log_batch(run_id, params=[Param(name, value) for name, value in shown.items()])
    return run_id


def _send(client: MlflowClient, run: str, metrics: Sequence[Metric]) -> None:
    for first in range(0, len(metrics), BATCH):
        client.log_batch(run, metrics=metrics[first : first + BATCH])


def _keep(
    client: MlflowClient,
    run: str,
    metrics: Mapping[str, Any],
    tags: Mapping[str, str],
    files: Sequence[Path],
) -> None:
    now = int(time.time() * 1000)
    numbers = {
        name: float(value)
        for name, value in metrics.items()
        if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    }
    client.log_batch(
        run,
        metrics=[Metric(name, value, now, 0) for name, value in numbers.items()],
        tags=[RunTag(name, value) for name, value in tags.items()],
    )
    for file in files:
        client.log_artifact(run, str(file))


def _end(client: MlflowClient, run: str, status: str, reason: str) -> None:
    if reason:
        client.set_tag(run, REASON, reason)
    client.set_terminated(run, status)


def _all_runs(client: MlflowClient, experiment: str) -> list[Run]:
    runs, token = [], None
    while True:
        page = client.search_runs([experiment], page_token=token)
        runs += page
        if not (token := page.token):
            return runs
