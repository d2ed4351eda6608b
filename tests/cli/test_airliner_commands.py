"""The airliner's commands from limits to a selected network, on the quick preset's few samples."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from flexsurr.aerodynamics.features import COEFFICIENTS
from flexsurr.cli.flight import accuracy, fly, fly_randomly, fly_references
from flexsurr.cli.samples import sample
from flexsurr.cli.scoring import score_map
from flexsurr.cli.selection import select
from flexsurr.cli.tracking import store
from flexsurr.cli.training import train_map
from flexsurr.config.flight import DoubletTimes
from flexsurr.config.settings import load
from flexsurr.report.airliner_flight_figures import figure_19
from flexsurr.report.tables import airliner_accuracy, airliner_modes, cost
from flexsurr.report.training_figures import coefficient_errors
from flexsurr.storage import StorageError, read_samples
from flexsurr.surrogates import load_map
from flexsurr.tracking.store import read_store
from flexsurr.workflow.plan import Plan

ROOT = Path(__file__).parents[2]
PLAN = Plan(load(ROOT, ["config/config.yaml", "config/presets/quick.yaml"])).studies["airliner"]


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> Path:
    """Everything the commands write, made in the order in which the rules make it."""
    root = tmp_path_factory.mktemp("results")
    for name in PLAN.datasets():
        for shard in range(PLAN.shards(name)):
            sample(PLAN.simulate(name, shard), shard_path(root, shard, name))
    store({"uri": None, "studies": ["airliner"]}, root / "mlflow" / "airliner.json")
    for run_id, run in PLAN.runs.items():
        folder = root / "runs" / run_id
        train_map(PLAN.train(run_id), [root / run.variant], root / "mlflow" / "airliner.json", folder)
        weights = (folder / "weights.npz", folder / "best.npz")
        score_map(PLAN.score(run_id), folder / "fit.json", *weights, [], folder / "metrics.json")
    choose(root / "runs", root / "selected.json")
    tables = (root / "accuracy.parquet", root / "errors.parquet")
    accuracy(PLAN.accuracy(), root / "selected.json", root / "runs", root, *tables)
    return root


def shard_path(root: Path, shard: int, name: str = "pseudo_random") -> Path:
    return root / name / f"shard-{shard:04d}.parquet"


def choose(runs: Path, output: Path) -> None:
    select(PLAN.select(), runs, output)


def test_a_shard_comes_out_the_same_from_its_seed_and_number(results, tmp_path):
    again = tmp_path / "shard.parquet"
    sample(PLAN.simulate("pseudo_random", 1), again)
    first, second = read_samples(shard_path(results, 1)), read_samples(again)
    np.testing.assert_array_equal(first.u, second.u)
    np.testing.assert_array_equal(first.y, second.y)
    assert first.metadata == second.metadata
    assert (first.metadata.first, first.metadata.count) == (64, 32)


def test_the_table_has_each_coefficient_once_for_each_model(results):
    table = pd.read_parquet(results / "accuracy.parquet")
    assert list(table.columns) == ["output", "train_nmse", "validation_nmse", "validation_r2", "model"]
    assert set(table["model"]) == {run.trial.label for run in PLAN.runs.values()}
    for model in set(table["model"]):
        assert tuple(table.loc[table["model"] == model, "output"]) == COEFFICIENTS
    np.testing.assert_allclose(table["validation_r2"], 1.0 - table["validation_nmse"])


def test_the_selected_network_is_the_one_that_was_tabulated(results):
    chosen = json.loads((results / "selected.json").read_text())["network"]
    folder = results / "runs" / chosen["run_id"]
    network = load_map(folder / "weights.npz")
    samples = read_samples(shard_path(results, 0))
    assert network(samples.u).shape == samples.y.shape
    errors = pd.read_parquet(results / "errors.parquet")
    nmse = np.mean(errors[[f"error_{name}" for name in COEFFICIENTS]].to_numpy() ** 2)
    assert nmse == pytest.approx(chosen["validation_nmse"], rel=1e-9)
    assert len(errors) == round(0.2 * 96)


def test_runs_are_on_the_tracking_page(results):
    from mlflow import MlflowClient

    page = read_store(results / "mlflow" / "airliner.json")
    runs = MlflowClient(page.uri).search_runs([page.experiments["airliner"]])
    assert {run.data.tags.get("flexsurr.run_id") for run in runs} >= set(PLAN.runs)


@pytest.fixture
def without_networks(results, tmp_path) -> Path:
    """A selection of runs of which no network has finished, and of the others all."""
    runs = tmp_path / "runs"
    for run_id, run in PLAN.runs.items():
        figures = json.loads((results / "runs" / run_id / "metrics.json").read_text())
        if run.trial.architecture == "network":
            figures["status"] = "failed"
        (runs / run_id).mkdir(parents=True)
        (runs / run_id / "metrics.json").write_text(json.dumps(figures))
    choose(runs, tmp_path / "selected.json")
    return tmp_path / "selected.json"


def test_without_a_network_that_finished_the_lattice_flies_alone(results, without_networks, tmp_path):
    names = ("modes", "left_out", "elastic_modes", "doublets", "trims")
    made = [tmp_path / f"{name}.parquet" for name in names]
    fly(PLAN.fly(), without_networks, results / "runs", *made)
    doublets = pd.read_parquet(tmp_path / "doublets.parquet")
    assert set(doublets["model"]) == {"vlm_frozen", "quadratic"}
    modes = airliner_modes(pd.read_parquet(tmp_path / "modes.parquet"))
    assert modes["reference_real"].notna().all()
    assert modes["surrogate_real"].isna().all()
    names = ("flights", "exceedances", "cost", "rows", "limits")
    made = [tmp_path / f"{name}.parquet" for name in names]
    references = tmp_path / "references.parquet"
    fly_references(PLAN.fly(), references)
    fly_randomly(PLAN.fly(), without_networks, results / "runs", references, *made)
    rows = cost(pd.read_parquet(tmp_path / "rows.parquet"))
    assert set(rows["model"]) == {"vlm_rebuild", "vlm_frozen", "vlm_frozen_one_mach", "quadratic"}
    assert len(pd.read_parquet(tmp_path / "limits.parquet")) == 0
    files = (tmp_path / "accuracy.parquet", tmp_path / "errors.parquet")
    accuracy(PLAN.accuracy(), without_networks, results / "runs", results, *files)
    assert set(airliner_accuracy(pd.read_parquet(files[0]))["model"]) == {"linear"}
    figure_19(doublets, DoubletTimes(**PLAN.fly()["flight"]["doublet"]))
    coefficient_errors(pd.read_parquet(files[1]))


def test_samples_of_another_configuration_are_refused(results, tmp_path):
    run_id = next(iter(PLAN.runs))
    job = {**PLAN.train(run_id), "configuration": "0" * 16}
    with pytest.raises(StorageError, match=r"shard-0000\.parquet: belongs to the configuration"):
        train_map(job, [results / "pseudo_random"], results / "mlflow" / "airliner.json", tmp_path)
