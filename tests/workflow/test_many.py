"""Many trials and shards: no command line grows with their number, and they share jobs."""

import re
import shutil
from pathlib import Path

import pytest

from flexsurr.storage import read_json

BEAM = "cantilever"
TARGETS = (f"results/selected/{BEAM}.json", f"results/tables/{BEAM}/training.html")
SWEEP, PRESET = "config/sweeps/quick.yaml", "config/presets/quick.yaml"
SINGLE = {"trials_per_job": 1, "shards_per_job": 1}


def commands(project) -> dict[str, str]:
    """The longest command of each name that a run would give to the shell."""
    output = project.run_well("--dry-run", "--printshellcmds", *TARGETS)
    lines = re.findall(r"python -m flexsurr \S+ .*", output)
    return {line.split()[3]: line for line in sorted(lines, key=len)}


def test_no_command_grows_with_trials_or_shards(make_project):
    few, many = make_project(), make_project()
    for project, count in ((few, 2), (many, 60)):
        project.change(SWEEP, "spaces.0.seed", list(range(10, 10 + count)))
        project.change(PRESET, "batches", SINGLE)
        project.change(PRESET, f"overrides.{BEAM}.dataset.trajectories", count)
        project.change(PRESET, f"overrides.{BEAM}.dataset.trajectories_per_shard", 1)
    short, long = commands(few), commands(many)
    assert {"simulate", "manifest", "train", "score", "select", "tabulate"} <= short.keys()
    assert {name: len(line) for name, line in long.items()} == {name: len(short[name]) for name in long}


@pytest.fixture(scope="module")
def one_by_one(make_project):
    """One variant of the quick cantilever with a job for each shard, training and score."""
    project = make_project()
    project.change(PRESET, "batches", SINGLE)
    project.change(PRESET, f"overrides.{BEAM}.variants", ["hamiltonian"])
    project.tell_no_page()
    project.run_well(TARGETS[0])
    return project


def without_times(metrics: Path) -> dict:
    return {key: value for key, value in read_json(metrics).items() if key not in ("wall_s", "processor_s")}


def test_batches_make_what_single_jobs_make(quick, one_by_one, make_project):
    study, both = one_by_one.plan.studies[BEAM], quick.plan.studies[BEAM]
    assert study.runs.keys() < both.runs.keys()
    for variant in study.variants:
        manifest = f"datasets/{BEAM}/{variant}/manifest.json"
        assert read_json(one_by_one.results / manifest) == read_json(quick.results / manifest)
    for key in study.runs:
        metrics = f"runs/{key}/metrics.json"
        assert without_times(one_by_one.results / metrics) == without_times(quick.results / metrics)
    singly, together = (
        project.scheduled("--forceall", *TARGETS) for project in (one_by_one, make_project(quick))
    )
    assert {"trials", "shards"}.isdisjoint(singly)
    assert (singly["train"], singly["score"]) == (len(study.runs), len(study.runs))
    assert {"train", "score", "simulate"}.isdisjoint(together)
    assert singly["simulate"] > len(study.variants)
    assert (together["trials"], together["shards"]) == (1, len(both.variants))


def test_a_batch_makes_again_only_the_trial_that_is_gone(copy_of_quick):
    project = copy_of_quick
    project.tell_no_page()
    batches = project.plan.trial_batches[BEAM]
    batch, keys = max(batches.items(), key=lambda item: len(item[1]))
    lost, *kept = keys
    assert kept
    shutil.rmtree(project.results / "runs" / lost)
    marker = f"results/batches/{BEAM}/trials-{batch}.json"
    before = {key: (project.results / f"runs/{key}/weights.npz").stat().st_mtime_ns for key in kept}
    assert project.scheduled(BEAM)["trials"] == 1
    assert project.scheduled(marker) == {"trials": 1}
    project.run_well(marker)
    assert (project.results / f"runs/{lost}/metrics.json").is_file()
    assert {key: (project.results / f"runs/{key}/weights.npz").stat().st_mtime_ns for key in kept} == before


def test_the_jobs_of_a_large_sweep_do_not_grow_with_it(make_project):
    project = make_project()
    project.change(PRESET, "batches", {"trials_per_job": None})
    project.change(SWEEP, "spaces.0.seed", list(range(150)))
    jobs = project.scheduled(TARGETS[0])
    assert 64 < jobs["trials"] <= 128
    assert "train" not in jobs
