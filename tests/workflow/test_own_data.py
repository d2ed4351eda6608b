"""A study of the user's own files from end to end: ingested, trained, scored, selected, timed and drawn."""

import hashlib
import json

import pandas as pd
import pytest

from flexsurr.evaluation.published_tasks import SPRING, recordings
from flexsurr.storage import read_manifest, read_shards

STUDY = "spring"


@pytest.fixture(scope="module")
def own(make_project):
    """The spring's study with sweep and integrator of the quick preset, whose kernels are compiled."""
    project = make_project()
    preset = "config/presets/quick.yaml"
    project.change(preset, "studies", [STUDY])
    project.change(preset, "overrides", {STUDY: {"sweeps": {"default": "config/sweeps/quick.yaml"}}})
    project.change(
        preset,
        f"overrides.{STUDY}.rollouts",
        {"repeats": 1, "integrator": {"method": "rk4", "step_s": 0.02, "rtol": None, "atol": None}},
    )
    (project.root / "data").mkdir()
    frame = recordings(SPRING, seed=0, trajectories=6)[["trajectory", "t", "q", "p"]]
    frame.to_csv(project.root / "data" / "spring.csv", index=False)
    project.run_well()
    return project


def test_the_files_become_a_dataset_that_says_where_it_comes_from(own):
    manifest = read_manifest(own.results / "datasets" / STUDY / "files" / "manifest.json")
    content = (own.root / "data" / "spring.csv").read_bytes()
    assert manifest.origin == {
        "files": {"data/spring.csv": hashlib.sha256(content).hexdigest()},
        "derivatives": "estimated",
        "filter": {"kind": "savitzky_golay", "window": 15, "order": 3, "smooth_states": True},
    }
    (shard,) = read_shards(manifest)
    assert (shard.metadata.state_names, shard.metadata.state_units) == (("q", "p"), ("m", "kg m/s"))
    assert sorted(manifest.train + manifest.validation) == list(range(6))


def test_runs_are_scored_by_rollouts_and_one_of_each_architecture_is_selected(own):
    (selected,) = json.loads((own.results / "selected" / f"{STUDY}.json").read_text()).values()
    assert {"hnn", "mlp", "polynomial"} <= set(selected)
    for key in own.plan.runs:
        metrics = json.loads((own.results / "runs" / key / "metrics.json").read_text())
        assert metrics["status"] == "finished"
        assert metrics["held_out_nmse"] > 0.0
        assert metrics["diverged"] == 0 < metrics["long_response_error_percent_worst"]
    assert selected["hnn"]["own_energy_drift_percent"] < 0.1
    assert selected["mlp"]["own_energy_drift_percent"] is None


def test_every_figure_and_table_is_there(own):
    for name in own.plan.figures(STUDY):
        assert (own.results / "figures" / STUDY / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    for name in own.plan.tables(STUDY):
        table = pd.read_csv(own.results / "tables" / f"{name}.csv")
        assert len(table) > 0
        assert set(table["study"]) == {STUDY}
    cost = pd.read_csv(own.results / "tables" / "rollout_cost.csv")
    assert set(cost["implementation"]) == {"numpy", "compiled", "torch"}
    assert not (own.results / "evaluation" / STUDY / "statics.parquet").exists()


def test_another_file_is_another_dataset(own):
    assert own.scheduled() == {}
    with (own.root / "data" / "spring.csv").open("a") as file:
        file.writelines(f"6,{0.1 * k},0.5,{0.1 * k}\n" for k in range(20))
    scheduled = own.scheduled()
    assert scheduled["ingest"] == scheduled["manifest"] == 1
    assert scheduled["trials"] == len(own.plan.trial_batches[STUDY])
