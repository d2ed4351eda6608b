"""Killed jobs, a killed Snakemake, Ctrl-C: running again ends with the same results and nothing half done."""

import json
import os
import re
import signal
from pathlib import Path

import numpy as np
import pytest
from mlflow import MlflowClient
from project import eventually

from flexsurr.tracking.description import RUN_KEY
from flexsurr.tracking.store import store_uri

BEAM = "cantilever"
TARGETS = (f"results/selected/{BEAM}.json",)
LONG_SWEEP = """
search: grid
spaces:
  - architecture: hnn
    hidden: [[8]]
    activation: [tanh]
    optimiser: [adam]
    epochs: [12000]
    batch_size: [8]
    learning_rate: [1.0e-3]
"""


KILL_WAIT_S = 30.0
"""By default Slurm's KillWait: so long after SIGTERM it sends SIGKILL."""


@pytest.fixture(scope="module")
def prepared(quick, make_project):
    """The quick preset with one long training instead of its sweep, not yet run."""
    project = make_project(quick)
    (project.root / "config/sweeps/quick.yaml").write_text(LONG_SWEEP)
    project.change("config/presets/quick.yaml", "batches.trials_per_job", 1)
    project.change("config/presets/quick.yaml", f"overrides.{BEAM}.variants", ["hamiltonian"])
    return project


@pytest.fixture(scope="module")
def undisturbed(prepared, make_project):
    project = make_project(prepared)
    project.run_well(*TARGETS)
    return project


@pytest.fixture
def disturbed(prepared, make_project):
    return make_project(prepared)


def training_processes(project) -> list[int]:
    """Of every train command at work in this project, found by what /proc says of it."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().split(b"\0")
            here = (folder / "cwd").resolve() == project.root.resolve()
        except OSError:
            continue
        if here and words[1:4] == [b"-m", b"flexsurr", b"train"]:
            found.append(int(folder.name))
    return found


def wait_until_it_learns(project) -> list[int]:
    """Wait until a training has told of its progress; the processes that train."""
    for path in project.results.glob("logs/train/*.log"):
        path.unlink()

    def learning() -> bool:
        logs = [path.read_text() for path in project.results.glob("logs/train/hnn-*.log")]
        return any("epoch" in text for text in logs) and len(training_processes(project)) > 0

    eventually(learning)
    return training_processes(project)


def results_of(project) -> dict[str, dict]:
    """Losses and weights of every run of the long sweep."""
    found = {}
    for key in project.plan.studies[BEAM].runs:
        folder = project.results / "runs" / key
        fit = json.loads((folder / "fit.json").read_text())
        with np.load(folder / "weights.npz") as weights:
            found[key] = {name: weights[name] for name in weights.files}
        found[key] |= {name: fit[name] for name in ("status", "epochs", "train_nmse", "validation_nmse")}
    return found


def running_trials(project) -> list[str]:
    """The run_ids of what is under way, by what the page says."""
    client = MlflowClient(store_uri(None, project.results / "mlflow"))
    experiment = client.get_experiment_by_name(BEAM)
    running = client.search_runs([experiment.experiment_id], "attributes.status = 'RUNNING'")
    return [run.data.tags[RUN_KEY] for run in running if RUN_KEY in run.data.tags]


def jobs_told_to_stop_end_their_runs_at_once(project) -> None:
    """SIGTERM, with a cluster's deadline: the run on the page is KILLED before anything runs again."""
    snakemake = project.start(*TARGETS)
    for process in wait_until_it_learns(project):
        os.kill(process, signal.SIGTERM)
    eventually(lambda: training_processes(project) == [], within_s=KILL_WAIT_S)
    assert snakemake.wait(120) != 0
    assert running_trials(project) == []


def killed_jobs_end_snakemake(project) -> None:
    snakemake = project.start(*TARGETS)
    for process in wait_until_it_learns(project):
        os.kill(process, signal.SIGKILL)
    assert snakemake.wait(120) != 0
    assert running_trials(project) != []  # nobody could tell the page


def a_second_snakemake_in_the_folder_is_refused_and_ctrl_c_ends_the_first(project) -> None:
    snakemake = project.start(*TARGETS)
    wait_until_it_learns(project)
    code, output = project.run(*TARGETS, said="second.out")
    assert code != 0
    assert "cannot be locked" in output
    assert snakemake.poll() is None
    os.killpg(snakemake.pid, signal.SIGINT)
    assert snakemake.wait(120) != 0
    eventually(lambda: training_processes(project) == [])


def after_a_killed_snakemake_the_next_asks_to_be_unlocked(project) -> None:
    """The jobs of the killed one live on for a while."""
    snakemake = project.start(*TARGETS)
    wait_until_it_learns(project)
    snakemake.kill()
    snakemake.wait(120)
    code, output = project.run(*TARGETS)
    assert code != 0
    assert "--unlock" in output
    project.run_well("--unlock")


def finishes_as_if_undisturbed(project, undisturbed) -> None:
    """Run again: the same results, nothing left running, nothing half written, nothing more to do."""
    project.run_well(*TARGETS)
    np.testing.assert_equal(results_of(project), results_of(undisturbed))
    client = MlflowClient(store_uri(None, project.results / "mlflow"))
    experiment = client.get_experiment_by_name(BEAM)
    assert client.search_runs([experiment.experiment_id], "attributes.status = 'RUNNING'") == []
    finished = client.search_runs([experiment.experiment_id], "attributes.status = 'FINISHED'")
    assert set(project.plan.studies[BEAM].runs) <= {run.data.tags.get(RUN_KEY) for run in finished}
    assert [path for path in project.results.rglob(".*") if re.search(r"\.part$|\.\d+$", path.name)] == []
    assert list(project.results.glob("runs/*/checkpoint*")) == []
    assert "Nothing to be done" in project.run_well(*TARGETS)


def test_a_sweep_interrupted_in_every_way_ends_as_if_undisturbed(disturbed, undisturbed):
    """One story: each interruption meets what the one before it has left, and one run ends them all."""
    jobs_told_to_stop_end_their_runs_at_once(disturbed)
    killed_jobs_end_snakemake(disturbed)
    a_second_snakemake_in_the_folder_is_refused_and_ctrl_c_ends_the_first(disturbed)
    after_a_killed_snakemake_the_next_asks_to_be_unlocked(disturbed)
    finishes_as_if_undisturbed(disturbed, undisturbed)
