"""A study of the user's own files: what is wrong is said before any job, and what its jobs depend on."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from editing import change

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.settings import load
from flexsurr.workflow.plan import Plan

REPOSITORY = Path(__file__).resolve().parents[2]
STUDY, SWEEP, DATA = "config/studies/spring.yaml", "config/sweeps/spring.yaml", "data/spring.csv"
FILES = ["config/config.yaml", "own.yaml"]


@pytest.fixture
def root(root: Path) -> Path:
    (root / "own.yaml").write_text("studies: [spring]\n")
    write(root, recorded())
    return root


def recorded(trajectories: int = 4, samples: int = 20) -> pd.DataFrame:
    t = np.tile(np.linspace(0.0, 1.0, samples), trajectories)
    number = np.repeat(np.arange(trajectories), samples)
    return pd.DataFrame({"t": t, "trajectory": number, "q": np.cos(t + number), "p": -np.sin(t + number)})


def write(root: Path, frame: pd.DataFrame) -> None:
    (root / "data").mkdir(exist_ok=True)
    frame.to_csv(root / DATA, index=False)


def plan(root: Path) -> Plan:
    return Plan(load(root, FILES))


def refusal(root: Path) -> list[str]:
    with pytest.raises(ConfigurationError) as refused:
        plan(root)
    return str(refused.value).splitlines()


COLUMNS = yaml.safe_load((REPOSITORY / STUDY).read_text())["columns"]
STATES = {"t": "t", "trajectory": "trajectory", "states": [{"column": "q", "unit": "m"}]}

BAD = [
    ("source", "file", ["source: 'file'", "allowed: trajectories, samples, files"]),
    ("files", ["data/spring.csv", "data/absent.npz"], ["files: data/absent.npz: no such file"]),
    ("files", [], ["files", "at least one"]),
    ("columns.t", "time", ["files: data/spring.csv: has no column time; there are: t, trajectory, q, p"]),
    ("columns.pairs.0.q", {"column": "q"}, ["columns.pairs[0].q.unit: missing"]),
    ("columns.pairs.0.p", {"column": "p", "unit": ""}, ["columns.pairs[0].p.unit", "at least one character"]),
    ("columns.pairs.0.p.column", "q", ["columns", "q more than once"]),
    ("columns.pairs.0.p.derivative", "dp", ["derivative: missing for q", "for every state, or for none"]),
    ("columns.pairs", [], ["columns", "0 and 0", "pairs of q and p, or else states"]),
    (
        "columns.states",
        [{"column": "p", "unit": "m"}],
        ["columns", "1 and 1", "pairs of q and p, or else states"],
    ),
    ("columns.velocity", "v", ["columns.velocity: unknown key", "allowed: t, trajectory, pairs, states"]),
    ("columns.trajectory", None, ["data/spring.csv: row 21: t is 0 after 1"]),
    ("filter.window", 21, ["data/spring.csv: 20 samples of trajectory 0; allowed: at least 21, the window"]),
    ("filter.window", 4, ["filter", "window: 4 is not allowed; allowed: odd, more than order"]),
    ("filter.order", 15, ["filter", "window: 15 is not allowed; allowed: odd, more than order"]),
    ("structure", "config/structures/wing.yaml", ["structure: unknown key"]),
    ("training_fraction", 1.0, ["training_fraction", "less than 1"]),
]


@pytest.mark.parametrize(("keys", "value", "words"), BAD)
def test_what_is_wrong_with_the_study_is_one_line(root, keys, value, words):
    change(root, STUDY, keys, value)
    lines = refusal(root)
    assert len(lines) == 1
    for word in [STUDY, *words]:
        assert word in lines[0]


def test_what_is_wrong_with_the_data_is_said_before_any_job(root):
    write(root, recorded().assign(q=lambda f: f["q"].where(f.index != 4)))
    (line,) = refusal(root)
    assert line.startswith(f"{STUDY}: files: {DATA}: row 5: q is nan; allowed: a finite number")


def test_one_trajectory_can_be_split_by_sample_only(root):
    write(root, recorded(trajectories=1))
    (line,) = refusal(root)
    assert line.startswith(f"{STUDY}: files: hold one trajectory")
    change(root, STUDY, "split_by", "sample")
    assert plan(root).studies["spring"].manifest("files")["trajectories"] == 1


def test_states_that_are_no_pairs_take_a_network_without_structure(root):
    change(root, STUDY, "columns", STATES)
    lines = refusal(root)
    assert len(lines) == 3
    for line, word in zip(lines, ("'polynomial'", "'hnn'", "scaling: 'canonical'"), strict=True):
        assert line.startswith(f"{SWEEP}: ")
        assert word in line
        assert f"columns.states of {STUDY}" in line
    space = {"architecture": "mlp", "hidden": [[8]], "activation": ["tanh"], "scaling": ["per_feature"]}
    change(root, SWEEP, "spaces", [space])
    assert len(plan(root).runs) == 1


def test_nothing_can_be_sampled_where_there_is_no_structure(root):
    change(root, SWEEP, "spaces.0.configurations", [100])
    (line,) = refusal(root)
    assert line == f"{SWEEP}: configurations: {STUDY} has no structure to sample; allowed: to leave it out"


def jobs(root: Path) -> dict[str, str]:
    spring = plan(root).studies["spring"]
    found = {"ingest": spring.ingest(), "manifest": spring.manifest("files")}
    found |= {"rollouts": spring.rollouts(), "rollout_cost": spring.rollout_cost()}
    for key in spring.runs:
        found |= {f"train {key}": spring.train(key), f"score {key}": spring.score(key)}
    return {name: json.dumps(job, sort_keys=True) for name, job in found.items()}


NAMED = {"train"}  # a run on other data is another run
DATASET = {"ingest", "manifest", *NAMED, "score"}

CHANGES = [
    ("columns.pairs.0.q.unit", "mm", DATASET),
    ("filter.smooth_states", False, DATASET),
    ("seed", 7, DATASET),
    ("training_fraction", 0.6, DATASET - {"ingest"}),
    ("split_by", "sample", DATASET - {"ingest"}),
    ("rollouts.integrator.rtol", 1e-9, {"score", "rollouts", "rollout_cost"}),
    ("rollouts.trajectories", 2, {"score", "rollouts", "rollout_cost"}),
    ("rollouts.drawn", 1, {"rollouts"}),
    ("rollouts.repeats", 1, {"rollout_cost"}),
]


@pytest.mark.parametrize(("keys", "value", "rules"), CHANGES)
def test_a_value_changes_the_jobs_that_depend_on_it_and_no_others(root, keys, value, rules):
    before = jobs(root)
    change(root, STUDY, keys, value)
    after = jobs(root)
    assert {name.split()[0] for name in before.keys() | after if before.get(name) != after.get(name)} == rules


def test_other_data_are_other_runs(root):
    before = jobs(root)
    write(root, recorded().assign(p=lambda f: 2.0 * f["p"]))
    after = jobs(root)
    assert {name.split()[0] for name in before.keys() ^ after} == {"train", "score"}
    assert not any(name in after for name in before if name.startswith("train"))
    assert before["manifest"] != after["manifest"]


def test_the_manifest_says_where_the_data_come_from(root):
    origin = plan(root).studies["spring"].manifest("files")["origin"]
    assert list(origin["files"]) == [DATA]
    assert len(origin["files"][DATA]) == 64
    assert origin["derivatives"] == "estimated"
    assert origin["filter"] == {"kind": "savitzky_golay", "window": 15, "order": 3, "smooth_states": True}


def test_a_structure_is_asked_of_nothing(root):
    p = plan(root)
    assert p.figures("spring") == [
        "rollouts",
        "phase_plane",
        "training_loss",
        "training_epochs",
        "trials",
        "pareto",
    ]
    assert p.tables("spring") == [
        "sweeps",
        "training",
        "architectures",
        "seeds",
        "rollout_errors",
        "rollout_cost",
    ]


@pytest.mark.parametrize("shards_per_job", [None, 1, 4])
def test_the_shard_of_a_users_files_is_waited_for_itself(root, shards_per_job):
    change(root, "own.yaml", "batches", {"shards_per_job": shards_per_job})
    p = plan(root)
    files = p.studies["spring"].shard_files("files")
    assert p.waits_for(files) == files == ["datasets/spring/files/shard-0000.parquet"]
