"""The airliner's configuration and the jobs that follow from it."""

from pathlib import Path

import numpy as np
import pytest

from flexsurr.aerodynamics.features import FEATURES
from flexsurr.aerodynamics.sampling import draw_features, feature_intervals
from flexsurr.config.aerodynamics import load_feature_limits
from flexsurr.config.errors import ConfigurationError
from flexsurr.config.settings import load
from flexsurr.config.trial import MapNetwork
from flexsurr.workflow.plan import Plan
from flexsurr.workflow.sample_plan import SamplePlan

ROOT = Path(__file__).parents[2]
STUDY = "config/studies/airliner.yaml"
LIMITS = "config/aircraft/gnba_limits.yaml"
SWEEP = "config/sweeps/airliner.yaml"


def airliner(root: Path) -> SamplePlan:
    return Plan(load(root, ["config/config.yaml"])).studies["airliner"]


def edit(root: Path, file: str, old: str, new: str) -> None:
    path = root / file
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def test_shards_cover_all_samples_once():
    plan = airliner(ROOT)
    jobs = [plan.simulate("sobol", shard) for shard in range(plan.shards("sobol"))]
    numbers = [n for job in jobs for n in range(job["first"], job["first"] + job["count"])]
    assert numbers == list(range(plan.resolved.study.dataset.samples))


def test_there_are_baselines_and_the_network_of_the_study():
    trials = [run.trial for run in airliner(ROOT).runs.values()]
    assert {trial.architecture for trial in trials} == {"network", "linear", "quadratic"}
    networks = [trial for trial in trials if isinstance(trial, MapNetwork)]
    assert (75, "tanh", 250) in [(trial.hidden[0], trial.activation, trial.epochs) for trial in networks]


def test_a_changed_limit_asks_for_new_samples_and_a_changed_seed_of_weights_does_not(root):
    before = airliner(root)
    edit(root, SWEEP, "epochs: [250]", "epochs: [251]")
    other_epochs = airliner(root)
    assert other_epochs.simulate("sobol", 0) == before.simulate("sobol", 0)
    assert other_epochs.runs.keys() != before.runs.keys()
    edit(root, LIMITS, "low: 7000.0", "low: 7500.0")
    other_limits = airliner(root)
    assert other_limits.dataset_hash("sobol") != before.dataset_hash("sobol")
    assert not other_limits.runs.keys() & before.runs.keys()


@pytest.mark.parametrize(
    ("file", "old", "new", "problem"),
    [
        (
            LIMITS,
            "low: 7000.0, high: 12000.0",
            "low: 7000.0, high: 7000.0",
            "altitude_m.*low: 7000 is not allowed; allowed: below high: 7000",
        ),
        (LIMITS, "high: 0.80", "high: 0.95", r"mach: 0\.55 to 0\.95 is not allowed.*Prandtl"),
        (LIMITS, "beta_deg:", "betta_deg:", "betta_deg.*did you mean 'beta_deg'"),
        (
            SWEEP,
            "{architecture: linear,",
            "{architecture: linear, hidden: [[5]],",
            "hidden does nothing with linear",
        ),
        (SWEEP, "hidden: [[75]]", "hidden: []", r"hidden.*empty"),
        (SWEEP, "epochs: [250]", "epoch: [250]", r"spaces\[2\]\.epoch: unknown key.*did you mean 'epochs'"),
        (
            STUDY,
            "source: samples",
            "source: sample",
            r"source: 'sample' is not allowed",
        ),
        (SWEEP, "hidden: [[75]]", "hidden: [[75, 5]]", r"hidden\[0\]: one hidden layer, not 2"),
        (SWEEP, "architecture: linear", "architecture: hnn", r"'hnn' is not allowed.*'linear'.*'network'"),
        (STUDY, "held_out: 0.2", "held_out: 1.0", "held_out"),
        (STUDY, "wing: [24, 5]", "wing: [24, 1]", "wing"),
    ],
)
def test_mistakes_are_refused_by_name(root, file, old, new, problem):
    edit(root, file, old, new)
    with pytest.raises(ConfigurationError, match=problem) as error:
        airliner(root)
    assert file in str(error.value)


def test_a_file_that_is_not_there_is_named(root):
    edit(root, STUDY, SWEEP, "config/none.yaml")
    with pytest.raises(ConfigurationError, match=r"sweeps\.default: 'config/none\.yaml' is no file") as error:
        airliner(root)
    assert str(error.value).startswith(f"{STUDY}: ")


@pytest.mark.parametrize("sampling", ["pseudo_random", "sobol"])
def test_samples_depend_on_their_number_and_not_on_their_shard(sampling):
    low, high = feature_intervals(load_feature_limits(ROOT / LIMITS))
    whole = draw_features(low, high, seed=3, first=0, count=40, sampling=sampling)
    part = draw_features(low, high, seed=3, first=17, count=5, sampling=sampling)
    np.testing.assert_array_equal(part, whole[17:22])
    assert np.all((whole >= low) & (whole <= high))
    assert not np.array_equal(whole, draw_features(low, high, seed=4, first=0, count=40, sampling=sampling))


def test_limits_are_in_the_order_and_units_of_the_features():
    limits = load_feature_limits(ROOT / LIMITS)
    low, high = feature_intervals(limits)
    assert len(low) == len(FEATURES)
    at = FEATURES.index
    assert (low[at("mach")], high[at("mach")]) == (limits.mach.low, limits.mach.high)
    assert high[at("q_over_V")] == limits.q_over_V_rad_m.high
    assert high[at("alpha")] == pytest.approx(np.radians(limits.alpha_deg.high))
    assert high[at("delta_r")] == pytest.approx(np.radians(limits.delta_r_deg.high))
    assert low[at("eta_1")] == limits.eta[0].low
    assert high[at("eta_dot_6_over_V")] == limits.eta_dot_over_V[5].high
