"""A real MLflow server before a real PostgreSQL, both on loopback and both started here."""

import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import closing, contextmanager
from multiprocessing import get_context
from pathlib import Path

import mlflow
import numpy as np
import pandas as pd
import psycopg2
import pytest
from mlflow import MlflowClient
from pictures import QUIET_SERVER
from run_folders import described, write_run
from test_champion import MODEL, PARAMS, choose, oscillator

from flexsurr.cli.tracking import store, track
from flexsurr.tracking.description import RUN_KEY
from flexsurr.tracking.run_files import UNLOGGED
from flexsurr.tracking.store import read_store
from flexsurr.tracking.trial import tracked
from flexsurr.training.saved_surrogate import save_surrogate

pytestmark = pytest.mark.filterwarnings("ignore::pandas.errors.Pandas4Warning")  # MLflow's own
PATIENCE_S = 120.0
EPOCHS = 700
USER = "postgres"  # whom Debian's package makes; PostgreSQL refuses to run as root


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """A server that is away refuses at once; one that is there may take its time on a busy machine."""
    monkeypatch.setenv("MLFLOW_HTTP_REQUEST_TIMEOUT", str(int(PATIENCE_S)))


def programs() -> Path:
    """The folder of PostgreSQL's programs, which Debian keeps off the PATH."""
    found = shutil.which("initdb")
    folders = [Path(found).parent] if found else sorted(Path("/usr/lib/postgresql").glob("*/bin"))
    assert folders, "no PostgreSQL on this machine: make postgresql"
    return folders[-1]


def as_its_user(*command: str) -> list[str]:
    """`command`, for root as the user of PostgreSQL."""
    if os.getuid() != 0:
        return [*command]
    return ["setpriv", f"--reuid={USER}", f"--regid={USER}", "--clear-groups", *command]


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def end(process: subprocess.Popen, number: int) -> None:
    """End a process that was started here, and those that it started."""
    os.killpg(process.pid, number)
    process.wait(PATIENCE_S)


def eventually(happens) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not happens():
        assert time.monotonic() < end_s, "it did not happen"
        time.sleep(0.2)


@pytest.fixture(scope="module")
def postgresql() -> Iterator[str]:
    """The address of an empty database."""
    port = free_port()
    # not pytest's folder, into which nobody but its owner may look
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        data, output = Path(folder) / "data", Path(folder) / "output"
        if os.getuid() == 0:
            shutil.chown(folder, USER, USER)
        made = [str(programs() / "initdb"), "-D", str(data), "-U", "flexsurr", "--auth=trust", "--no-sync"]
        done = subprocess.run(
            as_its_user(*made), cwd=folder, capture_output=True, text=True, timeout=PATIENCE_S
        )
        assert done.returncode == 0, done.stderr
        served = [str(programs() / "postgres"), "-D", str(data), "-k", folder, "-p", str(port), "-F"]
        with output.open("w") as log:
            server = subprocess.Popen(
                as_its_user(*served, "-h", "127.0.0.1"),
                cwd=folder,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        try:
            eventually(lambda: "ready to accept connections" in output.read_text())
            yield f"postgresql://flexsurr@127.0.0.1:{port}/postgres"
        finally:
            end(server, signal.SIGINT)


@contextmanager
def serving(database: str, folder: Path, port: int) -> Iterator[str]:
    """The address of an MLflow server on a database, that keeps artefacts in `folder`."""
    folder.mkdir(exist_ok=True)
    command = [sys.executable, "-m", "mlflow", "server", "--backend-store-uri", database, "--workers", "1"]
    command += ["--artifacts-destination", str(folder), "--host", "127.0.0.1", "--port", str(port)]
    with (folder / "server.log").open("w") as log:
        server = subprocess.Popen(
            command,
            cwd=folder,
            env=os.environ | QUIET_SERVER,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    address = f"http://127.0.0.1:{port}"

    def healthy() -> bool:
        assert server.poll() is None, (folder / "server.log").read_text()
        try:
            urllib.request.urlopen(f"{address}/health", timeout=5).close()
            return True
        except (urllib.error.URLError, OSError):
            return False

    try:
        eventually(healthy)
        yield address
    finally:
        end(server, signal.SIGTERM)
        eventually(lambda: not listens(port))  # its workers end after it


def train(results: Path, key: str) -> None:
    folder = write_run(results / "runs", key)
    with tracked(read_store(results / "mlflow/store.json"), described(key), folder) as trial:
        for epoch in range(EPOCHS):
            trial.epoch(epoch, 1.0 / (1 + epoch), 1.0)
        trial.keep()


def runs_of(uri: str) -> dict[str, str]:
    """The status of each trial on the page."""
    client = MlflowClient(uri)
    experiment = client.get_experiment_by_name("cantilever").experiment_id
    runs = client.search_runs([experiment])
    return {run.data.tags[RUN_KEY]: run.info.status for run in runs if RUN_KEY in run.data.tags}


def test_four_writers_an_outage_and_a_champion(postgresql, tmp_path):
    """One story, for a server takes half a minute to start."""
    results, port = tmp_path / "results", free_port()
    keys = [f"hnn-{number}" for number in range(4)]
    with serving(postgresql, tmp_path / "kept", port) as address:
        store({"uri": address, "studies": ["cantilever"]}, results / "mlflow/store.json")
        context = get_context("spawn")
        writers = [context.Process(target=train, args=(results, key)) for key in keys]
        for writer in writers:
            writer.start()
        for writer in writers:
            writer.join(PATIENCE_S)
            assert writer.exitcode == 0
        assert runs_of(address) == dict.fromkeys(keys, "FINISHED")
        client = MlflowClient(address)
        for run in client.search_runs(list(read_store(results / "mlflow/store.json").experiments.values())):
            if RUN_KEY in run.data.tags:
                losses = client.get_metric_history(run.info.run_id, "train_loss")
                np.testing.assert_array_equal([loss.step for loss in losses], range(EPOCHS))
                assert len(run.inputs.dataset_inputs) == 1

    save_surrogate(oscillator(4.0, "hnn-9"), write_run(results / "runs", "hnn-9") / "weights.npz")
    choose(results, "hnn-9", 0.5)
    train(results, "hnn-9")
    assert [path.parent.name for path in (results / "runs").glob(f"*/{UNLOGGED}")] == ["hnn-9"]

    with serving(postgresql, tmp_path / "kept", port) as address:
        track(results, sync=True, uri=None)
        assert runs_of(address) == dict.fromkeys([*keys, "hnn-9"], "FINISHED")
        mlflow.set_tracking_uri(address)
        try:
            champion = mlflow.pyfunc.load_model(f"models:/{MODEL}@champion")
        finally:
            mlflow.set_tracking_uri(None)
        response = champion.predict(pd.DataFrame({"eta_1": [0.5], "p_1": [0.0]}), params=PARAMS)
        assert response["eta_1"].iloc[-1] == pytest.approx(0.5 * np.cos(2.0 * PARAMS["duration_s"]), rel=1e-6)


def test_a_database_without_a_server_keeps_artefacts_beside_the_results(postgresql, tmp_path):
    results = tmp_path / "results"
    with closing(psycopg2.connect(postgresql)) as connection:
        connection.autocommit = True
        connection.cursor().execute("CREATE DATABASE alone")
    uri = postgresql.replace("/postgres", "/alone")
    store({"uri": uri, "studies": ["cantilever"]}, results / "mlflow/store.json")
    train(results, "hnn-1")
    assert runs_of(uri) == {"hnn-1": "FINISHED"}
    assert [*(results / "mlflow/artifacts/cantilever").rglob("weights.npz")] != []
