"""The airliner's configuration and the jobs that follow from it."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from flexsurr.aerodynamics.features import FEATURES
from flexsurr.aerodynamics.sampling import draw_features, feature_intervals
from flexsurr.config.airliner import AirlinerFiles
from flexsurr.config.errors import ConfigurationError
from flexsurr.config.feature_limits import load_feature_limits
from flexsurr.workflow.airliner_plan import AirlinerPlan

ROOT = Path(__file__).parents[2]
FILES = AirlinerFiles()


@pytest.fixture
def copy(tmp_path) -> Path:
    shutil.copytree(ROOT / "config", tmp_path / "config")
    return tmp_path


def edit(root: Path, file: str, old: str, new: str) -> None:
    path = root / file
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def test_shards_cover_all_samples_once():
    plan = AirlinerPlan.load(ROOT, FILES)
    jobs = [plan.sample("sobol", shard) for shard in range(plan.shards)]
    numbers = [n for job in jobs for n in range(job["first"], job["first"] + job["count"])]
    assert numbers == list(range(plan.airliner.sweep.dataset.samples))


def test_there_are_baselines_and_the_network_of_the_study():
    trials = AirlinerPlan.load(ROOT, FILES).runs.values()
    assert {trial.model for trial in trials} == {"network", "linear", "quadratic"}
    assert any((trial.hidden, trial.activation, trial.epochs) == (75, "tanh", 250) for trial in trials)


def test_a_changed_limit_asks_for_new_samples_and_a_changed_seed_of_weights_does_not(copy):
    before = AirlinerPlan.load(copy, FILES)
    edit(copy, FILES.sweep, "epochs: [250]", "epochs: [251]")
    other_epochs = AirlinerPlan.load(copy, FILES)
    assert other_epochs.sample("sobol", 0) == before.sample("sobol", 0)
    assert other_epochs.runs.keys() != before.runs.keys()
    edit(copy, FILES.limits, "low: 7000.0", "low: 7500.0")
    other_limits = AirlinerPlan.load(copy, FILES)
    assert other_limits.configuration("sobol") != before.configuration("sobol")
    assert not other_limits.runs.keys() & before.runs.keys()


@pytest.mark.parametrize(
    ("file", "old", "new", "problem"),
    [
        (
            FILES.limits,
            "low: 7000.0, high: 12000.0",
            "low: 7000.0, high: 7000.0",
            "altitude_m.*not below high",
        ),
        (FILES.limits, "high: 0.80", "high: 0.95", r"mach: 0\.55 to 0\.95 is not allowed.*Prandtl"),
        (FILES.limits, "beta_deg:", "betta_deg:", "betta_deg.*did you mean 'beta_deg'"),
        (FILES.sweep, "{model: linear}", "{model: linear, hidden: [5]}", "least squares"),
        (FILES.sweep, "hidden: [75]", "hidden: []", r"hidden.*empty"),
        (FILES.sweep, "held_out: 0.2", "held_out: 1.0", "held_out"),
        (FILES.sweep, "wing: [24, 5]", "wing: [24, 1]", "wing"),
    ],
)
def test_mistakes_are_refused_by_name(copy, file, old, new, problem):
    edit(copy, file, old, new)
    with pytest.raises(ConfigurationError, match=problem) as error:
        AirlinerPlan.load(copy, FILES)
    assert file in str(error.value)


def test_a_file_that_is_not_there_is_named():
    with pytest.raises(ConfigurationError, match=r"config/none\.yaml: no such file"):
        AirlinerPlan.load(ROOT, AirlinerFiles(sweep="config/none.yaml"))


@pytest.mark.parametrize("sampling", ["pseudo_random", "sobol"])
def test_samples_depend_on_their_number_and_not_on_their_shard(sampling):
    low, high = feature_intervals(load_feature_limits(ROOT / FILES.limits))
    whole = draw_features(low, high, seed=3, first=0, count=40, sampling=sampling)
    part = draw_features(low, high, seed=3, first=17, count=5, sampling=sampling)
    np.testing.assert_array_equal(part, whole[17:22])
    assert np.all((whole >= low) & (whole <= high))
    assert not np.array_equal(whole, draw_features(low, high, seed=4, first=0, count=40, sampling=sampling))


def test_limits_are_in_the_order_and_units_of_the_features():
    limits = load_feature_limits(ROOT / FILES.limits)
    low, high = feature_intervals(limits)
    assert len(low) == len(FEATURES)
    at = FEATURES.index
    assert (low[at("mach")], high[at("mach")]) == (limits.mach.low, limits.mach.high)
    assert high[at("q_over_V")] == limits.q_over_V_rad_m.high
    assert high[at("alpha")] == pytest.approx(np.radians(limits.alpha_deg.high))
    assert high[at("delta_r")] == pytest.approx(np.radians(limits.delta_r_deg.high))
    assert low[at("eta_1")] == limits.eta[0].low
    assert high[at("eta_dot_6_over_V")] == limits.eta_dot_over_V[5].high
