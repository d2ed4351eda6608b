"""A study of several numbers of modes: which runs it has, what its jobs depend on, and what it refuses."""

import json
from pathlib import Path

import pytest
import yaml
from editing import change

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.settings import load
from flexsurr.workflow.plan import Plan

REPOSITORY = Path(__file__).resolve().parents[2]
NAME, PRESET = "crossover", "config/presets/crossover.yaml"
STUDY, SWEEP = "config/studies/crossover.yaml", "config/sweeps/crossover.yaml"
FURTHER = "config/sweeps/crossover_degree_6.yaml"


def plan(root: Path) -> Plan:
    return Plan(load(root, ["config/config.yaml", PRESET]))


def refusal(root: Path) -> list[str]:
    with pytest.raises(ConfigurationError) as error:
        plan(root)
    return list(error.value.problems)


def jobs(root: Path) -> dict[str, str]:
    p = plan(root)
    found = {f"rivals {modes}": p.job("rivals", NAME, modes) for modes in p.studies[NAME].plans}
    for key in p.runs:
        found |= {f"train {key}": p.job("train", key), f"score {key}": p.job("score", key)}
    return {name: json.dumps(job, sort_keys=True) for name, job in found.items()}


def test_every_trial_is_trained_for_each_number_of_modes(root):
    study = plan(root).studies[NAME]
    sizes = {modes: len(of.runs) for modes, of in study.plans.items()}
    assert list(sizes) == ["3", "6", "8", "10"]
    # but for a sweep for the first three, and one for the first alone
    assert sizes["3"] - 1 == sizes["6"] == sizes["8"] == sizes["10"] + 1
    assert sum(sizes.values()) == len(study.runs)
    for modes, of in study.plans.items():
        assert all(study.train(key)["part"]["reduction"]["modes"] == int(modes) for key in of.runs)
        assert study.rivals(modes)["runs"] == list(of.runs)


def test_nothing_is_simulated_and_a_table_and_a_figure_are_made(root):
    p = plan(root)
    assert all(p.studies[NAME].trains_on(key) == p.studies[NAME].scored_on(key) == [] for key in p.runs)
    assert (p.figures(NAME), p.tables(NAME)) == (["crossover"], ["crossover"])
    assert p.files(NAME, "rivals-*") == [f"evaluation/crossover/rivals-{r}.parquet" for r in (3, 6, 8, 10)]


ALL = {"train", "score", "rivals"}
CHANGES = [
    (STUDY, "initial_conditions.q_max_deg", 3.0, ALL),
    (STUDY, "normalisation", "unit", ALL),
    ("config/structures/hale_wing.yaml", "length_m", 15.0, ALL),
    (STUDY, "seed", 7, {"score", "rivals"}),
    (STUDY, "evaluation.duration_s", 20.0, {"score", "rivals"}),
    (STUDY, "evaluation.integrator.step_s", 0.002, {"score", "rivals"}),
    (STUDY, "evaluation.long_responses", 3, {"score"}),
    (STUDY, "evaluation.simulations", 3, {"rivals"}),
    (STUDY, "evaluation.repeats", 3, {"rivals"}),
    (FURTHER, "spaces.0.degree", [4, 6], {"train", "score", "rivals"}),
]


@pytest.mark.parametrize(("file", "keys", "value", "rules"), CHANGES)
def test_a_value_changes_the_jobs_that_depend_on_it_and_no_others(root, file, keys, value, rules):
    before = jobs(root)
    change(root, file, keys, value)
    after = jobs(root)
    assert {name.split()[0] for name in before.keys() | after if before.get(name) != after.get(name)} == rules


@pytest.mark.parametrize(
    ("file", "keys", "value", "line"),
    [
        (
            STUDY,
            "modes",
            [3, 6, 8, 60],
            f"{STUDY}: modes: 60 is not allowed; allowed: 1 to 48, the coordinates of",
        ),
        (STUDY, "modes", [3, 6, 8, 3], f"{STUDY}: modes: 3 more than once; allowed: each at most once"),
        (STUDY, "trained_for", {"default": [3]}, "'default' is not allowed; allowed: degree_6"),
        (
            STUDY,
            "trained_for.degree_6",
            [3, 5],
            "trained_for.degree_6: 5 is not allowed; allowed: 3, 6, 8, 10",
        ),
        (SWEEP, "spaces.0.configurations", None, "spaces[0].configurations: a key without values"),
        (STUDY, "evaluation.output_step_s", 0.7, "duration_s: 30 is not allowed with output_step_s: 0.7"),
    ],
)
def test_what_does_not_fit_is_refused_by_its_file(root, file, keys, value, line):
    change(root, file, keys, value)
    assert line in refusal(root)[0]


def test_data_sets_have_no_place_in_it(root):
    content = yaml.safe_load((root / FURTHER).read_text())
    del content["spaces"][0]["configurations"]
    (root / FURTHER).write_text(yaml.safe_dump(content))
    (line,) = refusal(root)
    assert line.startswith(f"{STUDY}: sweeps.degree_6: '{FURTHER}' has a space without configurations")
