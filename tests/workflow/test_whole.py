"""The quick preset from end to end: what it makes, and that making it again takes nothing."""

import json
import math
import re

import numpy as np
import pandas as pd
import pytest

from flexsurr.storage import read_manifest, read_shards

BEAM = "cantilever"

TRAINING_COLUMNS = (
    "study,variant,run_id,architecture,configurations,hidden,activation,degree,terms,options,scaling,samples_per_trajectory,potential,mass_matrix,optimiser,"
    "learning_rate,weight_decay,batch_size,precision,device,loss,keep,patience,time_limit_s,give_up,seed,dataset,"
    "status,reason,epoch_limit,epochs,best_epoch,wall_s,processor_s,parameters,final_loss,train_nmse,validation_nmse,best_validation_nmse,published_loss,"
    "sampling,lattice,networks,inputs"
)
COST_COLUMNS = (
    "study,variant,response,model,implementation,integrator,simulations,wall_s_mean,wall_s_std,"
    "relative_to_described_percent,relative_to_described_std_percent,relative_to_numpy_percent,"
    "relative_to_compiled_percent,paper_percent,paper_std_percent,tip_error_percent,energy_drift_percent,"
    "diverged"
)
SWEEP_COLUMNS = (
    "study,sweep,variant,architecture,trials,finished,stopped,failed,processor_s,validation_nmse_median,"
    "validation_nmse_best,long_response_error_percent_best,best_run_id,outcome"
)
ANSWER_COLUMNS = (
    "study,response,variant,model,pays,times_as_fast,tip_error_percent,wall_s,integrator,reference,"
    "reference_integrator,reference_wall_s,times_as_fast_as_numpy,times_as_fast_as_described"
)
STATIC_COLUMNS = "load_N,x_exact_m,z_exact_m,x_fom_m,z_fom_m,x_rom_m,z_rom_m"
FREQUENCY_COLUMNS = "structure,mode,fom_rad_s,rom_rad_s,published_fom_rad_s,published_rom_rad_s"


@pytest.mark.parametrize(
    ("table", "columns"),
    [
        ("training", TRAINING_COLUMNS),
        ("cost", COST_COLUMNS),
        ("sweeps", SWEEP_COLUMNS),
        ("answer", ANSWER_COLUMNS),
        ("static_tip", STATIC_COLUMNS),
        ("natural_frequencies", FREQUENCY_COLUMNS),
    ],
)
def test_the_tables_have_the_columns_that_others_read(quick, table, columns):
    frame = pd.read_csv(quick.results / "tables" / f"{table}.csv")
    assert ",".join(frame.columns) == columns
    assert len(frame) > 0


def test_every_figure_and_table_is_there(quick):
    for study in (BEAM, "wing"):
        for name in quick.plan.figures(study):
            svg = quick.results / "figures" / study / f"{name}.svg"
            assert svg.read_text(encoding="utf-8").rstrip().endswith("</svg>")
            assert svg.with_suffix(".png").read_bytes().startswith(b"\x89PNG")
        for name in quick.plan.tables(study):
            assert (quick.results / "tables" / study / f"{name}.html").is_file()
    assert (quick.results / "report.html").stat().st_size > 100_000


def test_the_best_surrogates_stand_in_the_costs_of_forced_responses_under_learned_loads_too(quick):
    cost = pd.read_csv(quick.results / "tables" / "cost.csv")
    learned = cost[cost["model"].str.contains("_learned_load|_network_load")]
    assert set(learned["response"]) == {"forced"}
    assert (learned["diverged"] == 0).all()
    for study in (BEAM, "wing"):
        for variant in quick.plan.studies[study].variants:
            names = learned[(learned["study"] == study) & (learned["variant"] == variant)]["model"].unique()
            assert [name.endswith(("_learned_load", "_network_load")) for name in names] == [True, True]


def test_the_airliner_is_there_and_its_costs_stand_among_the_others(quick):
    figures = {path.stem for path in (quick.results / "figures" / "airliner").glob("*.png")}
    assert figures >= {
        *(f"figure_{number}" for number in range(16, 22)),
        "aileron_doublet",
        "rudder_doublet",
        "elastic_modes",
        "coefficient_errors",
    }
    for name in ("accuracy", "elastic_modes", "modes", "left_out_modes", "cost", "limits"):
        assert len(pd.read_csv(quick.results / "tables" / f"airliner_{name}.csv")) > 0
        assert (quick.results / "tables" / "airliner" / f"airliner_{name}.html").is_file()
    cost = pd.read_csv(quick.results / "tables" / "cost.csv")
    flown = cost[cost["study"] == "airliner"]
    assert {"vlm_rebuild", "vlm_frozen", "quadratic", "network"} <= set(flown["model"])
    assert set(flown["response"]) == {"manoeuvre"}


def test_the_dataset_is_whole_and_split_by_trajectory(quick):
    for variant in ("hamiltonian", "as_printed"):
        manifest = read_manifest(quick.results / "datasets" / BEAM / variant / "manifest.json")
        assert sorted(manifest.train + manifest.validation) == list(range(6))
        shards = list(read_shards(manifest))
        assert [shard.metadata.first for shard in shards] == [0, 3]
        assert all(shard.metadata.variant == variant for shard in shards)
        assert manifest.failures == ()
        q0 = np.concatenate([shard.x[np.isclose(shard.t, 0.0), 0] for shard in shards])
        assert np.all(np.abs(q0) <= np.pi / 9 + 1e-12)
        assert len(set(q0)) == 6


def test_every_run_is_recorded_and_scored(quick):
    runs = quick.plan.runs
    assert {path.name for path in (quick.results / "runs").iterdir()} == set(runs)
    for key, run in runs.items():
        folder = quick.results / "runs" / key
        metrics = json.loads((folder / "metrics.json").read_text())
        assert (metrics["run_id"], metrics["variant"], metrics["status"]) == (key, run.variant, "finished")
        assert metrics["validation_nmse"] < (math.inf if run.study == "airliner" else 1.0)
        assert ("long_response_error_percent_worst" in metrics) == (run.study != "airliner")
        parameters = json.loads((folder / "parameters.json").read_text())
        assert parameters["trial"] == run.trial.model_dump(mode="json")


def test_one_surrogate_of_each_architecture_is_selected(quick):
    selected = json.loads((quick.results / "selected" / f"{BEAM}.json").read_text())
    assert set(selected) == {"hamiltonian", "as_printed"}
    for variant, chosen in selected.items():
        assert {"hnn", "mlp", "polynomial"} <= set(chosen)
        for name in ("hnn", "mlp", "polynomial"):
            assert quick.plan.runs[chosen[name]["run_id"]].variant == variant


def test_a_network_of_ones_own_goes_all_the_way(quick):
    name = "examples/my_models.py:Oscillators"
    for variant in quick.plan.studies[BEAM].variants:
        run = json.loads((quick.results / "selected" / f"{BEAM}.json").read_text())[variant][name]
        assert run["run_id"].startswith("Oscillators-")
        assert (quick.results / "runs" / run["run_id"] / "weights.npz").is_file()
    training = pd.read_csv(quick.results / "tables" / "training.csv").set_index("architecture")
    assert (training.loc[name, "options"] == "hidden=8").all()
    cost = pd.read_csv(quick.results / "tables" / "cost.csv").query("model == @name")
    assert set(cost["response"]) == {"free", "forced"}
    assert set(cost["implementation"]) == {"torch", "compiled"}
    assert {method.partition("(")[0] for method in cost["integrator"]} == {"scipy_radau", "rk4"}
    assert (cost["diverged"] == 0).all()
    responses = pd.read_parquet(quick.results / "evaluation" / BEAM / "response-hamiltonian-free.parquet")
    assert name in set(responses["model"])


def test_every_rule_leaves_a_log(quick):
    logs = {path.relative_to(quick.results / "logs").parts[0] for path in quick.results.glob("logs/**/*.log")}
    assert {"shards", "manifest", "statics", "validation", "trials", "select"} <= logs
    assert {"accuracy", "fly", "fly_references", "fly_randomly"} <= logs
    assert {"rehearse", "evaluate", "responses", "draw", "tabulate"} <= logs


def test_nothing_half_written_is_left(quick):
    assert [
        path for path in quick.results.rglob("*") if re.fullmatch(r"\..*\.part|\..*\.\d+", path.name)
    ] == []


def test_making_it_again_takes_nothing(copy_of_quick):
    output = copy_of_quick.run_well()
    assert "Nothing to be done" in output


def test_the_runs_of_every_study_stand_in_one_table_with_all_their_settings(quick):
    training = pd.read_csv(quick.results / "tables" / "training.csv")
    assert set(training["study"]) == {BEAM, "wing", "airliner"}
    of_maps = training[training["study"] == "airliner"].set_index("run_id")
    for key, run in quick.plan.studies["airliner"].runs.items():
        row, trial = of_maps.loc[key], run.trial
        assert (row["sampling"], row["lattice"], row["optimiser"]) == (
            trial.sampling,
            trial.lattice,
            trial.optimiser,
        )
