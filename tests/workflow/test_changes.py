"""After a change, exactly what depends on it is made again."""

import shutil
from pathlib import Path

import pytest
from project import CONFIGURATION

from flexsurr.config.settings import load
from flexsurr.report.catalogue import FIGURES, TABLES
from flexsurr.workflow.plan import Plan
from flexsurr.workflow.sample_plan import EVALUATED

REPOSITORY = Path(__file__).resolve().parents[2]
BEAM = "cantilever"
OVER = f"overrides.{BEAM}"
QUICK = "config/presets/quick.yaml"
SWEEP = "config/sweeps/quick.yaml"

PLAN = Plan(load(REPOSITORY, CONFIGURATION))


def products_of(*reads: str, study: str = BEAM) -> dict[str, int]:
    """How many figures and tables of a study show any of what they `read`; the tables are then joined."""
    figures = [FIGURES[name] for name in PLAN.figures(study)]
    tables = [TABLES[name] for name in PLAN.tables(study)]
    drawn, tabulated = (
        sum(not set(reads).isdisjoint(product.reads) for product in products)
        for products in (figures, tables)
    )
    return {name: count for name, count in (("draw", drawn), ("tabulate", tabulated), ("join", 1)) if count}


RUNS = ("metrics", "relatives", "history")
COSTS = ("cost-*-*", "cost-*")
RESPONSES = ("response-*-free", "response-*-forced", "response-*-sustained", "energy-*")
SELECTED = {"select": 1, "responses": 2, "evaluate": 4, **products_of(*RUNS, *COSTS, *RESPONSES)}
FLOWN = {
    "select": 1,
    "accuracy": 1,
    "fly": 1,
    "fly_randomly": 1,
    **products_of("metrics", *EVALUATED, "cost-*", study="airliner"),
}
LEARNT = {
    "manifest": 2,
    "train": 8,
    "score": 10,
    "learn_load": 2,
    **SELECTED,
    **products_of(*RUNS, *COSTS, *RESPONSES, "learned_loads-*"),
}


@pytest.mark.parametrize(
    ("file", "keys", "value", "jobs"),
    [
        (SWEEP, "spaces.0.epochs", [21], {"train": 2, "score": 2, **SELECTED}),
        (SWEEP, "spaces.1.hidden", [[8], [4]], {"train": 2, "score": 2, **SELECTED}),
        (QUICK, f"{OVER}.dataset.trajectories", 9, {"simulate": 2, **LEARNT}),
        (QUICK, f"{OVER}.evaluation.repeats", 2, {"evaluate": 4, **products_of(*COSTS)}),
        (QUICK, f"{OVER}.evaluation.long_responses", 3, {"score": 10, **SELECTED}),
        (
            QUICK,
            f"{OVER}.statics.tip_loads_N",
            [0, 10],
            {"statics": 1, **products_of("statics", "frequencies")},
        ),
        (
            "config/sweeps/airliner_quick.yaml",
            "spaces.1.epochs",
            [6],
            {"train": 1, "score": 1, **FLOWN},
        ),
        ("config/config.yaml", "tracking.uri", "http://127.0.0.1:9", {}),
        ("config/config.yaml", "timing.cores", 1, {}),
    ],
)
def test_changing_a_value(copy_of_quick, file, keys, value, jobs):
    copy_of_quick.change(file, keys, value)
    assert copy_of_quick.scheduled() == jobs


def test_editing_the_file_of_a_network_of_ones_own_trains_it_anew(copy_of_quick):
    with (copy_of_quick.root / "examples" / "my_models.py").open("a") as source:
        source.write("# another thought\n")
    assert copy_of_quick.scheduled() == {"train": 2, "score": 2, **SELECTED}


@pytest.mark.parametrize(
    ("file", "made_again", "left_alone"),
    [
        (
            "flexsurr/beam/compiled.py",
            {"simulate", "statics", "validation", "manifest", "train", "responses", "evaluate"},
            {"accuracy", "fly", "fly_randomly"},
        ),
        (
            "flexsurr/evaluation/timing.py",
            {"evaluate", "join"},
            {"simulate", "manifest", "train", "statics"},
        ),
        (
            "flexsurr/storage/moments.py",
            {"manifest", "train"},
            {"simulate", "statics", "validation"},
        ),
        (
            "flexsurr/report/style.py",
            {"draw"},
            {"simulate", "train", "evaluate", "responses", "statics", "score", "select"},
        ),
        (
            "flexsurr/workflow/plan.py",
            set(),
            {"simulate", "train", "evaluate", "score", "select"},
        ),
    ],
)
def test_editing_code(copy_of_quick, file, made_again, left_alone):
    stray = shutil.ignore_patterns("__pycache__")
    shutil.copytree(copy_of_quick.code / "flexsurr", copy_of_quick.root / "flexsurr", ignore=stray)
    copy_of_quick.code = copy_of_quick.root
    with (copy_of_quick.root / file).open("a") as source:
        source.write("# another thought\n")
    scheduled = copy_of_quick.scheduled()
    assert made_again <= set(scheduled)
    assert not left_alone & set(scheduled)


def test_a_deleted_tracking_store_brings_nothing_back(copy_of_quick):
    for path in (copy_of_quick.results / "mlflow").glob("mlflow.db*"):
        path.unlink()
    assert copy_of_quick.scheduled() == {}


@pytest.mark.parametrize("uri", [None, "http://127.0.0.1:9"])
def test_a_study_that_is_added_is_built_at_once(copy_of_quick, uri):
    copy_of_quick.change("config/config.yaml", "studies", [BEAM, "wing", "wing_unit"])
    copy_of_quick.change("config/config.yaml", "tracking.uri", uri)
    scheduled = copy_of_quick.scheduled()
    added = copy_of_quick.plan
    assert scheduled["train"] == len(added.studies["wing_unit"].runs)
    assert scheduled["evaluate"] == 2 * len(added.studies["wing_unit"].variants)
    assert scheduled["join"] == 1


def test_without_a_store_results_are_made_all_the_same(copy_of_quick):
    copy_of_quick.change("config/config.yaml", "tracking.uri", "http://127.0.0.1:9")
    copy_of_quick.change(SWEEP, "spaces.1.hidden", [[4]])
    output = copy_of_quick.run_well(f"results/selected/{BEAM}.json")
    assert "results are made without it" in output
    assert copy_of_quick.scheduled(f"results/selected/{BEAM}.json") == {}
