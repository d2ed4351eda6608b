"""After a change, exactly what depends on it is made again."""

import json
import shutil
from itertools import chain
from pathlib import Path

import pandas as pd
import pytest
import yaml
from project import CONFIGURATION, NOWHERE

from flexsurr.config.settings import load
from flexsurr.report.catalogue import FIGURES, TABLES
from flexsurr.workflow.plan import Plan
from flexsurr.workflow.sample_plan import EVALUATION

REPOSITORY = Path(__file__).resolve().parents[2]
BEAM = "cantilever"
OVER = f"overrides.{BEAM}"
QUICK = "config/presets/quick.yaml"
SWEEP = "config/sweeps/quick.yaml"

PLAN = Plan(load(REPOSITORY, CONFIGURATION))


def products_of(*reads: str, study: str = BEAM) -> dict[str, int]:
    """The jobs that make figures and tables of a study which show what they `read`, and the last two."""
    jobs = {"join": 1, "answer": 1}
    for command, products in (("draw", FIGURES), ("tabulate", TABLES)):
        for shown, names in PLAN.made_together(study, products).items():
            if any(not set(reads).isdisjoint(products[name].reads) for name in names):
                jobs[f"{command}_{study}_{shown}"] = 1
    return jobs


RUNS = ("metrics", "relatives", "history")
COSTS = ("cost-*-*", "cost-*")
RESPONSES = ("response-*-free", "response-*-forced", "response-*-sustained", "energy-*")
SELECTED = {
    "select": 1,
    "responses": 2,
    "rehearse": 2,
    "evaluate": 2,
    **products_of(*RUNS, *COSTS, *RESPONSES),
}
FLOWN = {
    "select": 1,
    "accuracy": 1,
    "fly": 1,
    "fly_randomly": 1,
    **products_of("metrics", *chain(*EVALUATION.values()), "cost-*", study="airliner"),
}
LEARNT = {
    "manifest": 2,
    "trials": 1,
    "learn_load": 2,
    **SELECTED,
    **products_of(*RUNS, *COSTS, *RESPONSES, "learned_loads-*"),
}


@pytest.mark.parametrize(
    ("file", "keys", "value", "jobs"),
    [
        (SWEEP, "spaces.1.hidden", [[8], [4]], {"trials": 1, **SELECTED}),
        (QUICK, f"{OVER}.dataset.trajectories", 9, {"shards": 2, **LEARNT}),
        (QUICK, f"{OVER}.evaluation.repeats", 2, {"evaluate": 2, **products_of(*COSTS)}),
        (QUICK, f"{OVER}.evaluation.long_responses", 3, {"trials": 1, **SELECTED}),
        (
            QUICK,
            f"{OVER}.statics.tip_loads_N",
            [0, 10],
            {"statics": 1, **products_of("statics", "frequencies", "shapes")},
        ),
        (
            "config/sweeps/airliner_quick.yaml",
            "spaces.1.epochs",
            [6],
            {"trials": 1, **FLOWN},
        ),
        ("config/config.yaml", "tracking.uri", NOWHERE, {}),
        ("config/config.yaml", "timing.cores", 1, {}),
    ],
)
def test_changing_a_value(copy_of_quick, file, keys, value, jobs):
    copy_of_quick.change(file, keys, value)
    assert copy_of_quick.scheduled() == jobs


def test_editing_the_file_of_a_network_of_ones_own_trains_it_anew(copy_of_quick):
    with (copy_of_quick.root / "examples" / "my_models.py").open("a") as source:
        source.write("# another thought\n")
    assert copy_of_quick.scheduled() == {"trials": 1, **SELECTED}


def test_a_value_that_is_removed_deletes_nothing_and_one_that_comes_back_trains_nothing(copy_of_quick):
    copy_of_quick.tell_no_page()
    target = f"results/selected/{BEAM}.json"
    before = copy_of_quick.plan.studies[BEAM].runs
    spaces = yaml.safe_load((copy_of_quick.root / SWEEP).read_text())["spaces"]
    copy_of_quick.change(SWEEP, "spaces", [space for space in spaces if space["architecture"] != "mlp"])
    gone = before.keys() - copy_of_quick.plan.studies[BEAM].runs.keys()
    assert len(gone) == 2
    trained = {key: _fit(copy_of_quick, key) for key in before}
    # a batch that has lost a trial, or gets it back, looks at what there is, and makes nothing
    assert copy_of_quick.scheduled(target).keys() <= {"trials", "select"}
    copy_of_quick.run_well(target)
    selected = json.loads((copy_of_quick.root / target).read_text())
    assert not any("mlp" in chosen for chosen in selected.values())
    assert all((copy_of_quick.results / "runs" / key / "metrics.json").is_file() for key in gone)
    copy_of_quick.change(SWEEP, "spaces", spaces)
    copy_of_quick.run_well(target)
    selected = json.loads((copy_of_quick.root / target).read_text())
    assert all("mlp" in chosen for chosen in selected.values())
    assert trained == {key: _fit(copy_of_quick, key) for key in before}


def _fit(project, key):
    """The bytes of a run's fit, which has its times, and when it was written."""
    path = project.results / "runs" / key / "fit.json"
    return path.read_bytes(), path.stat().st_mtime_ns


def test_before_anything_runs_it_says_how_many_trials_are_new(copy_of_quick):
    trials = {name: len(study.runs) for name, study in copy_of_quick.plan.studies.items()}
    output = copy_of_quick.run_well("--dry-run")
    lines = [f"{name}: {count} trials, none of them new" for name, count in trials.items() if count > 1]
    assert len(lines) >= 2
    assert all(output.count(line) == 1 for line in lines)
    copy_of_quick.change(SWEEP, "spaces.1.hidden", [[8], [4]])
    assert f"{BEAM}: {trials[BEAM] + 2} trials, 2 of them new" in copy_of_quick.run_well("--dry-run")


def test_a_sweep_of_which_no_trial_finishes_ends_with_tables_that_say_so(copy_of_quick):
    rule = {"after_epochs": 2, "above_nmse": 1e-30}
    space = {"architecture": "hnn", "hidden": [[6]], "activation": ["half_log"], "give_up": [rule]}
    for sweep in (SWEEP, "config/sweeps/quick_data_free.yaml"):
        copy_of_quick.change(sweep, "spaces", [space])
    copy_of_quick.change(QUICK, f"{OVER}.variants", ["hamiltonian"])  # one, in half the time
    copy_of_quick.run_well(BEAM)
    tables = copy_of_quick.results / "tables" / BEAM
    sweeps = pd.read_csv(tables / "sweeps.csv")
    assert (sweeps["finished"] == 0).all()
    assert sweeps["outcome"].str.startswith("every trial was stopped; the first: the best valid").all()
    training = pd.read_csv(tables / "training.csv")
    assert (training["status"] == "stopped").all()
    assert training["reason"].str.contains("after 2 epochs, above 1e-30").all()
    assert "every trial was" in (tables / "sweeps.html").read_text()
    # what they are compared with is measured all the same
    assert set(pd.read_csv(tables / "cost.csv")["model"]) == {"rom"}


@pytest.fixture(scope="module")
def with_its_code(quick, make_project):
    """The finished quick preset with a copy of the package, which it runs; an edit is taken back."""
    project = make_project(quick)
    stray = shutil.ignore_patterns("__pycache__")
    shutil.copytree(project.code / "flexsurr", project.root / "flexsurr", ignore=stray)
    project.code = project.root
    assert project.scheduled() == {}
    return project


@pytest.mark.parametrize(
    ("file", "made_again", "left_alone"),
    [
        (
            "flexsurr/beam/compiled.py",
            {"shards", "statics", "validation", "manifest", "trials", "responses", "evaluate"},
            {"accuracy", "fly", "fly_references", "fly_randomly"},
        ),
        (
            "flexsurr/evaluation/timing.py",
            {"evaluate", "join"},
            {"shards", "manifest", "statics"},
        ),
        (
            "flexsurr/storage/scales.py",
            {"manifest", "trials"},
            {"shards", "statics", "validation"},
        ),
        (
            "flexsurr/report/style.py",
            {f"draw_{BEAM}_{shown}" for shown in PLAN.made_together(BEAM, FIGURES)},
            {"shards", "trials", "evaluate", "responses", "statics", "select"},
        ),
        (
            "flexsurr/workflow/plan.py",
            set(),
            {"shards", "trials", "evaluate", "select"},
        ),
    ],
)
def test_editing_code(with_its_code, file, made_again, left_alone):
    source = with_its_code.root / file
    before = source.read_text()
    source.write_text(before + "# another thought\n")
    try:
        scheduled = with_its_code.scheduled()
    finally:
        source.write_text(before)
    assert made_again <= set(scheduled)
    assert not left_alone & set(scheduled)


def test_a_deleted_tracking_store_brings_nothing_back(copy_of_quick):
    for path in (copy_of_quick.results / "mlflow").glob("mlflow.db*"):
        path.unlink()
    assert copy_of_quick.scheduled() == {}


@pytest.mark.parametrize("uri", [None, NOWHERE])
def test_a_study_that_is_added_is_built_at_once(copy_of_quick, uri):
    copy_of_quick.change("config/config.yaml", "studies", [BEAM, "wing", "wing_unit"])
    copy_of_quick.change("config/config.yaml", "tracking.uri", uri)
    scheduled = copy_of_quick.scheduled()
    added = copy_of_quick.plan
    assert scheduled["trials"] == len(added.trial_batches["wing_unit"])
    assert scheduled["evaluate"] == len(added.studies["wing_unit"].variants)
    assert scheduled["join"] == 1


def test_without_a_store_results_are_made_all_the_same(copy_of_quick):
    copy_of_quick.change("config/config.yaml", "tracking.uri", NOWHERE)
    copy_of_quick.change(SWEEP, "spaces.1.hidden", [[4]])
    output = copy_of_quick.run_well(f"results/selected/{BEAM}.json")
    assert "results are made without it" in output
    assert f"{BEAM}: not logged: 2 runs, scores, figures and champions" in output
    assert copy_of_quick.scheduled(f"results/selected/{BEAM}.json") == {}
