"""What each job depends on: changing a value changes the jobs that need it, and no others."""

import json
from pathlib import Path

import pytest
import yaml
from editing import change

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.settings import load
from flexsurr.evaluation.published import is_of_the_recipe
from flexsurr.report.catalogue import FIGURES, TABLES
from flexsurr.workflow.plan import Plan
from flexsurr.workflow.trajectory_plan import TrajectoryPlan

REPOSITORY = Path(__file__).resolve().parents[2]
QUICK = "config/presets/quick.yaml"
STUDY, SWEEP = "config/studies/cantilever.yaml", "config/sweeps/quick.yaml"
STRUCTURE = "config/structures/cantilever.yaml"
BEAM = "cantilever"


def plan(root: Path) -> Plan:
    return Plan(load(root, ["config/config.yaml", QUICK]))


def beam(plan: Plan) -> TrajectoryPlan:
    return plan.studies[BEAM]


def jobs(root: Path) -> dict[str, str]:
    """Every job of the quick preset as text, by rule and wildcards."""
    p = plan(root)
    found = {"store": p.store(), f"select {BEAM}": beam(p).select()}
    found |= {
        f"statics {BEAM}": beam(p).statics(),
        f"validation {BEAM}": beam(p).validation(),
    }
    found |= {f"train {key}": p.job("train", key) for key in p.runs}
    found |= {f"score {key}": p.job("score", key) for key in p.runs}
    for variant in beam(p).variants:
        found[f"manifest {variant}"] = beam(p).manifest(variant)
        found[f"respond {variant}"] = beam(p).respond(variant)
        found[f"rehearse {variant}"] = beam(p).rehearse(variant)
        found[f"cost {variant}"] = beam(p).cost(variant)
        for shard in range(beam(p).shards(variant)):
            found[f"simulate {variant} {shard}"] = beam(p).simulate(variant, shard)
    return {name: json.dumps(job, sort_keys=True) for name, job in found.items()}


NAMED = {"train", "score", "select"}  # a run on other data is another run
ALL_DATA = {"simulate", "manifest"} | NAMED
TIMED = {"rehearse", "cost"}
SCORED = {"score", "respond"} | TIMED
OVER = f"overrides.{BEAM}"

CHANGES = [
    (STRUCTURE, "length_m", 1.1, ALL_DATA | SCORED | {"statics", "validation"}),
    (STUDY, "seed", 7, ALL_DATA | SCORED),
    (STUDY, "dataset.step_s", 0.002, ALL_DATA),
    (STUDY, "dataset.training_fraction", 0.7, {"manifest"} | NAMED),
    (STUDY, "dataset.split_by", "sample", {"manifest"} | NAMED),
    (STUDY, "dataset.initial_conditions.q_max_deg", 10.0, ALL_DATA | SCORED),
    (STUDY, "evaluation.load.force_N", 5.0, {"validation", "respond"} | TIMED),
    (QUICK, f"{OVER}.evaluation.judging_integrator", {"method": "dop853"}, {"score"}),
    (QUICK, f"{OVER}.evaluation.drawing_integrator", {"method": "radau_iia_5"}, {"respond"}),
    (QUICK, f"{OVER}.evaluation.reference_integrator", {"method": "radau_iia_5"}, SCORED),
    (STUDY, "frequencies_also_of", ["config/structures/wing.yaml"], {"statics"}),
    (QUICK, f"{OVER}.dataset.trajectories", 9, ALL_DATA),
    (QUICK, f"{OVER}.evaluation.repeats", 2, {"cost"}),
    (QUICK, f"{OVER}.evaluation.described_simulations.as_printed", 2, {"cost"}),
    (QUICK, f"{OVER}.evaluation.simulations", 3, {"respond"} | TIMED),
    (QUICK, f"{OVER}.evaluation.long_responses", 3, {"score"}),
    (QUICK, f"{OVER}.selection.error_at_most_percent", 3.0, {"select"}),
    (QUICK, f"{OVER}.evaluation.duration_s", 0.3, SCORED),
    (QUICK, f"{OVER}.statics.tip_loads_N", [0, 10], {"statics"}),
    (SWEEP, "spaces.0.epochs", [21], {"train", "score", "select"}),
    ("config/config.yaml", "tracking.uri", "http://127.0.0.1:5000", {"store"}),
    ("config/config.yaml", "timing.cores", 1, set()),
    ("config/config.yaml", "results", "elsewhere", set()),
]


@pytest.mark.parametrize(("file", "keys", "value", "rules"), CHANGES)
def test_a_value_changes_the_jobs_that_depend_on_it_and_no_others(root, file, keys, value, rules):
    before = jobs(root)
    change(root, file, keys, value)
    after = jobs(root)
    assert before != after or not rules
    assert {name.split()[0] for name in before.keys() | after if before.get(name) != after.get(name)} == rules


def test_more_trajectories_leave_the_shards_that_are_there(root):
    before = jobs(root)
    change(root, QUICK, f"{OVER}.dataset.trajectories", 9)
    after = jobs(root)
    assert {name for name in after if name.startswith("simulate") and before.get(name) != after[name]} == {
        "simulate hamiltonian 2",
        "simulate as_printed 2",
    }


def test_a_new_value_of_the_sweep_adds_its_runs_and_leaves_the_others(root):
    before = jobs(root)
    change(root, SWEEP, "spaces.0.hidden", [[8], [9]])
    after = jobs(root)
    added = after.keys() - before.keys()
    assert sorted(name.split("-")[0] for name in added) == ["score hnn"] * 2 + ["train hnn"] * 2
    assert {name for name in before if before[name] != after[name]} == {f"select {BEAM}"}


def test_without_a_value_of_the_sweep_the_other_runs_stay_as_they_are(root):
    change(root, SWEEP, "spaces.3.degree", [4, 6])
    before = jobs(root)
    change(root, SWEEP, "spaces.3.degree", [4])
    after = jobs(root)
    gone = before.keys() - after.keys()
    assert sorted(name.split("-")[0] for name in gone) == ["score polynomial"] * 2 + ["train polynomial"] * 2
    assert {name for name in after if before[name] != after[name]} == {f"select {BEAM}"}


def test_the_plan_says_how_many_trials_are_new(root, tmp_path):
    runs = tmp_path / "runs"
    p = plan(root)
    studies = {name: list(study.runs) for name, study in p.studies.items()}
    assert p.trials(runs) == [
        f"{name}: {len(keys)} trial{'s' * (len(keys) > 1)}, {len(keys)} of them new"
        for name, keys in studies.items()
    ]
    for key in studies[BEAM]:
        (runs / key).mkdir(parents=True)
        (runs / key / "fit.json").touch()
    line = f"{BEAM}: {len(studies[BEAM])} trials, none of them new"
    assert line in p.trials(runs)
    change(root, SWEEP, "spaces.3.degree", [4, 6])
    line = f"{BEAM}: {len(studies[BEAM]) + 2} trials, 2 of them new"
    assert line in plan(root).trials(runs)
    (runs / studies[BEAM][0] / "fit.json").unlink()
    line = f"{BEAM}: {len(studies[BEAM]) + 2} trials, 3 of them new"
    assert line in plan(root).trials(runs)


def test_what_samples_configurations_needs_no_data_and_no_simulation(root):
    before, p = jobs(root), plan(root)
    (free, *_) = beam(p).select()["sweeps"]["data_free"]
    (trained, *_) = beam(p).select()["sweeps"]["default"]
    assert beam(p).trains_on(free) == []
    assert beam(p).trains_on(trained) == [f"datasets/{BEAM}/hamiltonian/manifest.json"]
    assert (beam(p).train(free)["dataset"], beam(p).train(trained)["dataset"]) == (
        "configurations",
        "default",
    )
    for key, value in {"trajectories": 9, "duration_s": 0.2, "training_fraction": 0.7}.items():
        change(root, QUICK, f"{OVER}.dataset.{key}", value)
    assert jobs(root)[f"train {free}"] == before[f"train {free}"]
    change(root, STUDY, "dataset.initial_conditions.q_max_deg", 10.0)
    assert f"train {free}" not in jobs(root)


def test_a_run_is_named_by_its_content(root):
    for key, run in plan(root).runs.items():
        assert key.startswith(f"{run.trial.architecture.rpartition(':')[2]}-")
    keys = list(plan(root).runs)
    change(root, SWEEP, "spaces", yaml.safe_load((root / SWEEP).read_text())["spaces"][::-1])
    assert sorted(plan(root).runs) == sorted(keys)


def test_a_further_dataset_is_drawn_by_its_own_seed_and_trained_on_by_the_sweep_that_says_so(root):
    before = jobs(root)
    many = {"seed": 7, "trajectories": 20, "trajectories_per_shard": 20, "step_s": 0.05}
    change(root, STUDY, "further_datasets.many", many)
    assert jobs(root) == before
    change(root, STUDY, "sweeps.many", SWEEP)
    change(root, STUDY, "trains_on.many", "many")
    p = plan(root)
    assert {name for name in before if before[name] != jobs(root)[name]} == {f"select {BEAM}"}
    sweeps = beam(p).select()["sweeps"]
    assert len(sweeps["many"]) == len(sweeps["default"])
    assert {p.runs[key].data for key in beam(p).select()["sweeps"]["many"]} == {
        "hamiltonian-many",
        "as_printed-many",
    }
    assert beam(p).shards("as_printed-many") == 1
    usual, further = (
        beam(p).simulate("hamiltonian", 0),
        beam(p).simulate("hamiltonian-many", 0),
    )
    assert (further["count"], further["part"]["seed"], further["variant"]) == (20, 7, "hamiltonian")
    assert further["part"]["dataset"]["step_s"] == 0.05
    assert further["configuration"] != usual["configuration"]
    assert beam(p).manifest("hamiltonian-many")["seed"] == 7


def test_the_last_shard_holds_what_is_left(root):
    change(root, QUICK, f"{OVER}.dataset.trajectories", 7)
    shards = [plan(root).studies[BEAM].simulate("hamiltonian", shard) for shard in range(3)]
    assert [(job["first"], job["count"]) for job in shards] == [(0, 3), (3, 3), (6, 1)]


def test_the_figure_of_architectures_sees_every_study_of_the_same_structure(root):
    change(root, "config/config.yaml", "studies", [BEAM, "wing", "wing_unit"])
    p = Plan(load(root, ["config/config.yaml"]))
    both = [f"runs/{key}/metrics.json" for name in ("wing", "wing_unit") for key in p.studies[name].runs]
    assert p.files("wing", "relatives") == p.files("wing_unit", "relatives") == both
    assert len(set(both)) == 2 * len(p.studies["wing"].runs)
    assert len(p.files(BEAM, "relatives")) == len(beam(p).runs)
    assert "architecture_errors" in p.figures("wing")
    assert "architecture_errors" not in p.figures(BEAM)


@pytest.mark.parametrize("products", [FIGURES, TABLES])
def test_every_product_is_made_by_one_job_that_waits_for_the_files_of_one_rule(products):
    p = Plan(load(REPOSITORY, ["config/config.yaml"]))
    for study in p.studies:
        together = p.made_together(study, products)
        names = [name for group in together.values() for name in group]
        assert sorted(names) == sorted(p.figures(study) if products is FIGURES else p.tables(study))
        for shown, group in together.items():
            files = p.shown(study, products, group)
            made = {
                f"evaluation/{study}/{name}.parquet" for name in p.studies[study].evaluation.get(shown, ())
            }
            match shown:
                case "design":
                    assert files == []
                case "runs":
                    assert all(file.startswith("runs/") for file in files)
                case _:
                    assert set() < set(files) <= made
            assert set(p.job("draw" if products is FIGURES else "tabulate", study, shown)) == set(group)


def test_a_trial_of_a_field_shares_a_job_and_one_of_a_map_has_its_own():
    p = Plan(load(REPOSITORY, ["config/config.yaml"]))
    assert p.trial_batches["airliner"] == {}
    assert max(map(len, p.trial_batches[BEAM].values())) > 1


def test_the_full_preset_times_every_baseline_on_every_simulation():
    p = Plan(load(REPOSITORY, ["config/config.yaml", "config/presets/full.yaml"]))
    assert set(p.studies) == set(Plan(load(REPOSITORY, ["config/config.yaml"])).studies)
    for study in (BEAM, "wing"):
        evaluation = p.studies[study].resolved.study.evaluation
        described = evaluation.described_simulations
        assert {described.as_printed, described.hamiltonian, evaluation.scipy_simulations} == {
            evaluation.simulations
        }
    flights = p.studies["airliner"].resolved.study.flight.random_flights
    assert flights.rebuild_flights == flights.frozen_flights == 3 * flights.of_each_doublet


def test_the_papers_preset_trains_its_recipes_on_its_data():
    p = Plan(load(REPOSITORY, ["config/config.yaml", "config/presets/paper.yaml"]))
    assert set(p.studies) == {BEAM, "wing_unit"}
    for study, architectures in (
        (BEAM, ["hnn", "hnn", "mlp", "mlp"]),
        ("wing_unit", ["dissipative_hnn", "mlp"]),
    ):
        runs = [p.runs[key] for key in p.studies[study].runs]
        assert [run.trial.architecture for run in runs] == architectures
        assert {run.data for run in runs} == {"as_printed"}
        dataset = p.studies[study].resolved.study.dataset
        assert (dataset.split_by, dataset.integrator.method) == ("sample", "scipy_radau")
        structure = p.studies[study].resolved.structure.name
        for run in runs:
            trial = run.trial
            described = {"structure": structure, **trial.model_dump(mode="json"), "epoch_limit": trial.epochs}
            assert is_of_the_recipe(described | {"hidden": str(trial.hidden[0])})


def test_other_data_make_other_runs_and_leave_the_old_ones(root):
    before = list(plan(root).studies[BEAM].runs)
    change(root, STRUCTURE, "elements", 12)
    assert set(before).isdisjoint(plan(root).runs)
    change(root, STRUCTURE, "elements", 10)
    assert list(plan(root).studies[BEAM].runs) == before


def test_a_structure_that_buckles_under_its_own_weight_is_refused_before_any_job(root):
    pole = {"clamp_theta_deg": 90.0, "gravity_m_s2": 9.81, "mass_per_length_kg_m": 60.0}
    for key, value in pole.items():
        change(root, STRUCTURE, key, value)
    with pytest.raises(ConfigurationError, match=f"{STRUCTURE}: gravity_m_s2: .*buckles under"):
        plan(root)


def test_of_a_turning_clamp_no_load_is_learned(root):
    turning = {"kind": "clamp_rotation", "rate_rad_s": 2.0, "history": {"kind": "smooth_ramp", "rise_s": 0.1}}
    change(root, STUDY, "evaluation.load", turning)
    p = plan(root)
    assert beam(p).evaluation["learn_load"] == []
    assert "learned_loads" not in p.tables(BEAM)
    assert "cost" in p.tables(BEAM)


def test_a_clamp_that_would_turn_at_once_is_refused_before_any_job(root):
    turning = {
        "kind": "clamp_rotation",
        "rate_rad_s": 2.0,
        "history": {"kind": "ramp", "rise_s": 9, "end_s": 1},
    }
    change(root, STUDY, "evaluation.load", turning)
    with pytest.raises(ConfigurationError) as caught:
        plan(root)
    assert [line for line in str(caught.value).splitlines() if "the clamp's rate jumps at 1 s" in line]
