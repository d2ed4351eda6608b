"""After a change, exactly what depends on it is made again."""

import shutil

import pytest

BEAM = "cantilever"
OVER = f"overrides.{BEAM}"
QUICK = "config/presets/quick.yaml"
SWEEP = "config/sweeps/quick.yaml"

EVALUATED = {"responses": 2, "evaluate": 4}
DRAWN_FROM_RESPONSES = {f"draw_{BEAM}_figure_{number}": 1 for number in (10, 12, 13)}
DRAWN_FROM_COSTS = {f"draw_{BEAM}_cost_accuracy": 1, f"tabulate_{BEAM}_cost": 1, "join": 1}
DRAWN_FROM_RUNS = {
    f"draw_{BEAM}_training_loss_training_epochs": 1,
    f"tabulate_{BEAM}_training_architectures_seeds": 1,
    "join": 1,
}
SELECTED = {
    f"judge_{BEAM}": 1,
    "select": 1,
    **EVALUATED,
    **DRAWN_FROM_RESPONSES,
    **DRAWN_FROM_COSTS,
    **DRAWN_FROM_RUNS,
}
FLOWN = {
    "select_coefficients": 1,
    "fly": 1,
    "fly_randomly": 1,
    "draw_airliner": 1,
    "show_airliner": 1,
    "join": 1,
}
LEARNT = {"manifest": 2, "train": 6, "learn_load": 2, f"tabulate_{BEAM}_learned_loads": 1, **SELECTED}


@pytest.mark.parametrize(
    ("file", "keys", "value", "jobs"),
    [
        (SWEEP, "spaces.0.epochs", [21], {"train": 2, **SELECTED}),
        (SWEEP, "spaces.1.hidden", [[8], [4]], {"train": 2, **SELECTED}),
        (QUICK, f"{OVER}.dataset.trajectories", 9, {"simulate_shard": 2, **LEARNT}),
        (QUICK, f"{OVER}.evaluation.repeats", 2, {"evaluate": 4, **DRAWN_FROM_COSTS}),
        (QUICK, f"{OVER}.evaluation.long_responses", 3, SELECTED),
        (
            QUICK,
            f"{OVER}.statics.tip_loads_N",
            [0, 10],
            {
                "statics": 1,
                f"draw_{BEAM}_figure_08": 1,
                **{f"tabulate_{BEAM}_{name}": 1 for name in ("static_tip", "natural_frequencies")},
                "join": 1,
            },
        ),
        (
            "config/sweeps/airliner_quick.yaml",
            "spaces.1.epochs",
            [6],
            {"train_coefficients": 1, **FLOWN},
        ),
        ("config/config.yaml", "tracking.uri", "http://127.0.0.1:9", {"tracking_store": 1}),
        ("config/config.yaml", "timing.cores", 1, {}),
    ],
)
def test_changing_a_value(copy_of_quick, file, keys, value, jobs):
    copy_of_quick.change(file, keys, value)
    assert copy_of_quick.scheduled() == jobs


@pytest.mark.parametrize(
    ("file", "made_again", "left_alone"),
    [
        (
            "flexsurr/beam/compiled.py",
            {"simulate_shard", "statics", "validation", "manifest", "train", "responses", "evaluate"},
            {"tracking_store"},
        ),
        (
            "flexsurr/evaluation/timing.py",
            {"evaluate", "join"},
            {"simulate_shard", "manifest", "train", "statics", f"draw_{BEAM}_figure_10"},
        ),
        (
            "flexsurr/storage/moments.py",
            {"manifest", "train"},
            {"simulate_shard", "statics", "validation"},
        ),
        (
            "flexsurr/report/style.py",
            {f"draw_{BEAM}_figure_10", f"draw_{BEAM}_cost_accuracy"},
            {"simulate_shard", "train", "evaluate", "responses", "statics", f"judge_{BEAM}", "select"},
        ),
        (
            "flexsurr/workflow/plan.py",
            set(),
            {"simulate_shard", "train", "evaluate", f"judge_{BEAM}", "select"},
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
