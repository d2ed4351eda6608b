"""The store of runs: where it is, what is in it, and how it is made."""

import json
import logging
import re
import sqlite3
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path

from mlflow import MlflowClient
from mlflow.entities import LifecycleStage
from mlflow.utils.mlflow_tags import MLFLOW_RUN_NAME

from flexsurr.storage import write_json

log = logging.getLogger(__name__)

SWEEP = "flexsurr.sweep"  # marks the parent run of a study's sweeps
KIND = {"mlflow.experimentKind": "custom_model_development"}  # not of language models
PLACES = {
    "experiments": ("artifact_location",),
    "runs": ("artifact_uri",),
    "logged_models": ("artifact_location",),
    "model_versions": ("source", "storage_location"),
}
"""The tables and columns of a database that say where artefacts lie."""


@dataclass(frozen=True)
class Store:
    """Where runs are recorded; of each study the experiment and the parent run of its sweeps."""

    uri: str
    experiments: Mapping[str, str]
    parents: Mapping[str, str]


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
    """The store that `write_store` wrote to `path`; None, and a warning, where there is none to be read.

    One without experiments was out of reach when it should have been made: its address is all that is known.
    """
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
        store = Store(**{**values, "uri": store_uri(values["uri"], path.parent)})
        if not isinstance(store.uri, str):
            raise TypeError(f"the address {store.uri!r}")
        return store
    except (OSError, ValueError, TypeError, KeyError) as error:
        warn(f"{path}: no store", error)
        return None


def create_store(uri: str, folder: Path, studies: Sequence[str]) -> Store | None:
    """Create the store, or what is missing in it; two processes must not do this at once.

    Artefacts of a database go into `folder`, and are looked for there where it has moved; a server keeps
    them as it likes. An experiment that was deleted on the page is restored. None, and a warning, where the
    store cannot be reached.
    """
    try:
        return _created(uri, folder, studies)
    # The server may be away, the database foreign or read-only: nothing of it is worth a result.
    except Exception as error:
        warn(f"{uri} is out of reach", error)
        return None


def _created(uri: str, folder: Path, studies: Sequence[str]) -> Store:
    folder.mkdir(parents=True, exist_ok=True)
    client = MlflowClient(uri)
    if uri == store_uri(None, folder):
        keep_artefacts_beside(folder)
    experiments, parents = {}, {}
    for study in studies:
        experiments[study] = _experiment(client, uri, folder, study)
        found = client.search_runs([experiments[study]], f"tags.`{SWEEP}` = '{study}'", max_results=1)
        if found:
            parents[study] = found[0].info.run_id
        else:
            tags = {SWEEP: study, "study": study, MLFLOW_RUN_NAME: f"sweeps of {study}"}
            parents[study] = client.create_run(experiments[study], tags=tags).info.run_id
    return Store(uri, experiments, parents)


def _experiment(client: MlflowClient, uri: str, folder: Path, study: str) -> str:
    """The experiment of a study as it should be."""
    is_server = uri.startswith(("http:", "https:"))
    place = None if is_server else (folder.absolute() / "artifacts" / study).as_uri()
    experiment = client.get_experiment_by_name(study)
    if experiment is None:
        created: str = client.create_experiment(study, artifact_location=place, tags=KIND)
        return created
    known: str = experiment.experiment_id
    if experiment.lifecycle_stage != LifecycleStage.ACTIVE:
        log.warning("tracking: the experiment %s had been deleted on the page; it is restored", study)
        client.restore_experiment(known)
    for tag, value in KIND.items():
        if tag not in experiment.tags:
            client.set_experiment_tag(known, tag, value)
    return known


def keep_artefacts_beside(folder: Path) -> None:
    """Have the database in `folder` look for artefacts there, wherever both were when they were made.

    MLflow itself knows no such move. Raises sqlite3.Error for a database that cannot be read, or written to.
    """
    if not database(folder).is_file():
        return
    with closing(sqlite3.connect(database(folder))) as connection, connection:
        for study, old in connection.execute("SELECT name, artifact_location FROM experiments").fetchall():
            new = (folder.absolute() / "artifacts" / study).as_uri()
            if old == new or not old.endswith(f"/artifacts/{study}"):
                continue
            for table, columns in PLACES.items():
                for column in columns:
                    moved = f"UPDATE {table} SET {column} = ? || substr({column}, ?)"
                    which = f"WHERE {column} = ? OR {column} LIKE ?"
                    connection.execute(f"{moved} {which}", (new, len(old) + 1, old, f"{old}/%"))


LONGEST_REASON = 300
logging.getLogger("urllib3").setLevel(logging.ERROR)  # a server that is away is our own warning


def warn(what: str, error: Exception) -> None:
    """Say on one line, without passwords, that results are made without `what`, and why."""
    reason = " ".join(f"{type(error).__name__}: {error}".split())[:LONGEST_REASON]
    without_secrets = shown(f"{what} ({reason})")
    log.warning("tracking: %s; results are made without it", without_secrets)


def shown(text: str) -> str:
    """`text` without the names and passwords of addresses in it."""
    return re.sub(r"://[^/@ ]*@", "://…@", text)
