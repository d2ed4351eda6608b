"""Bad configurations: each is refused with one line that names file, key, value and what is allowed."""

import errno
import os
import re
import shutil
from pathlib import Path

import pytest
import yaml
from editing import change

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.settings import RULES, load
from flexsurr.workflow.plan import Plan

REPOSITORY = Path(__file__).resolve().parents[2]
CONFIG = "config/config.yaml"
STUDY = "config/studies/cantilever.yaml"
STRUCTURE = "config/structures/cantilever.yaml"
AIRLINER = "config/studies/airliner.yaml"
SWEEP = "config/sweeps/cantilever.yaml"


def refusal(root: Path, *files: str) -> str:
    with pytest.raises(ConfigurationError) as caught:
        Plan(load(root, [CONFIG, *files]))
    return str(caught.value)


SPREAD = {"kind": "distributed", "along_z": {"force_N_m": 1.0}}
PUSH = {"kind": "tip_force", "force_N": 1.0}
BAD_VALUES = [
    (CONFIG, "resutls", "x", ["resutls", "'x'", "did you mean 'results'", "tracking"]),
    (CONFIG, "studies", [], ["studies", "[]", "at least one value"]),
    (CONFIG, "studies", ["cantilver"], ["studies", "'cantilver'", "allowed: airliner, cantilever"]),
    (CONFIG, "studies", ["soft beam"], ["studies", "'soft beam' is no name", "hyphens"]),
    (CONFIG, "studies", ["-x"], ["studies", "'-x' is no name", "hyphens"]),
    (CONFIG, "studies", ["train"], ["studies", "'train' is the name of a rule", "any other"]),
    (CONFIG, "studies", ["all"], ["studies", "'all' is the name of a rule"]),
    (CONFIG, "studies", ["draw_wing_runs"], ["studies", "'draw_wing_runs' is the name of a rule"]),
    (CONFIG, "studies", ["wing", "wing"], ["studies: wing more than once", "each at most once"]),
    (CONFIG, "results", "", ["results: ''", "at least one character"]),
    (CONFIG, "results", "out{1}", ["results", "'out{1}'", "without braces"]),
    (CONFIG, "results", "${ABSENT}/out", ["results", "'${ABSENT}/out'", "unknown $VARIABLE"]),
    (CONFIG, "results", "~no-such-user/out", ["results", "'~no-such-user/out'", "~user"]),
    (CONFIG, "results", "-out", ["results", "'-out'", "no folder"]),
    (CONFIG, "results", "out/..", ["results", "'out/..'", "the project's own folder"]),
    (CONFIG, "results", CONFIG, ["results", "is no folder", "is a file"]),
    (CONFIG, "tracking.uri", "127.0.0.1:5000", ["tracking.uri", "'127.0.0.1:5000'", "http://"]),
    (CONFIG, "tracking.uri", "http:/", ["tracking.uri", "'http:/'", "sqlite://"]),
    (CONFIG, "timing.cores", 0, ["timing.cores", "0", "greater than or equal to 1"]),
    (
        CONFIG,
        "overrides.wnig",
        {"seed": 1},
        ["overrides.wnig", "no such study", "cantilever, crossover, damped_spring"],
    ),
    (CONFIG, "overrides.cantilever.sede", 1, ["overrides.cantilever.sede", "1", "did you mean 'seed'"]),
    (STRUCTURE, "length_mm", 1000.0, ["length_mm", "1000.0", "did you mean 'length_m'"]),
    (STRUCTURE, "length_m", "1 m", ["length_m: '1 m' is not allowed; allowed: number"]),
    (STRUCTURE, "name", 5, ["name: 5", "allowed: text"]),
    (STRUCTURE, "length_m", -1.0, ["length_m", "-1.0", "greater than 0"]),
    (STRUCTURE, "length_m", float("nan"), ["length_m", "nan", "finite number"]),
    (STRUCTURE, "length_m", float("inf"), ["length_m", "inf", "finite number"]),
    (STRUCTURE, "length_m", True, ["length_m", "true is a truth value", "number"]),
    (STRUCTURE, "length_m", None, ["length_m: null", "allowed: number"]),
    (STRUCTURE, "elements", 0, ["elements", "0", "greater than or equal to 1"]),
    (STRUCTURE, "elements", "ten", ["elements: 'ten' is not allowed; allowed: integer"]),
    (STRUCTURE, "elements", 10.5, ["elements", "10.5", "integer"]),
    (STRUCTURE, "joints", ["torsion"] * 2, ["joints: torsion more than once"]),
    (STRUCTURE, "joints", [], ["joints", "at least one"]),
    (STRUCTURE, "joints", ["in_plain"], ["joints[0]", "'in_plain'", "did you mean 'in_plane'", "torsion"]),
    (STRUCTURE, "bending_stiffness_out_of_plane_N_m2", None, ["bending_stiffness_out_of_plane_N_m2: needed"]),
    (
        STRUCTURE,
        "torsional_inertia_per_length_kg_m",
        0.0,
        ["torsional_inertia_per_length_kg_m", "joint 'torsion'", "more than 0"],
    ),
    (STUDY, "dataset.duration_s", 0.2005, ["dataset: duration_s: 0.2005", "step_s: 0.001", "such as 0.2"]),
    (STUDY, "dataset.step_s", 0.5, ["dataset: duration_s: 0.2 ", "step_s: 0.5", "such as 0.5"]),
    (STUDY, "evaluation.output_step_s", 0.7, ["evaluation: duration_s: 30 ", "output_step_s: 0.7", "30.1"]),
    (STUDY, "source", ["samples"], ["source", "['samples']", "allowed: trajectories, samples"]),
    (STUDY, "reduction.modes", 1000, ["reduction.modes", "1000", "allowed: 1 to"]),
    (STUDY, "reduction.modes", 0, ["reduction.modes", "0", "greater than or equal to 1"]),
    (STUDY, "structure", "config/structures/absent.yaml", ["structure", "absent.yaml", "no file"]),
    (STUDY, "sweeps.default", "config/sweeps/absent.yaml", ["sweeps.default", "absent.yaml", "no file"]),
    (STUDY, "variants", ["hamiltonain"], ["variants[0]", "'hamiltonain'", "did you mean 'hamiltonian'"]),
    (STUDY, "dataset.duration", 0.2, ["dataset.duration", "0.2", "did you mean 'duration_s'"]),
    (STUDY, "dataset.training_fraction", 1.0, ["dataset.training_fraction", "1.0", "less than 1"]),
    (STUDY, "dataset", 5, ["dataset", "5", "keys with values"]),
    (STUDY, "variants", ["as_printed"] * 2, ["variants: as_printed more than once", "each at most once"]),
    (
        STUDY,
        "dataset.initial_conditions",
        {"q_min_deg": 5, "q_max_deg": 1},
        ["dataset.initial_conditions: q_min_deg: 5", "below q_max_deg: 1"],
    ),
    (
        STUDY,
        "dataset.initial_conditions",
        {"p_min_kg_m2_s": 5, "p_max_kg_m2_s": 1},
        ["dataset.initial_conditions: p_min_kg_m2_s: 5", "at most p_max_kg_m2_s: 1"],
    ),
    (AIRLINER, "dataset.samples", 1, ["dataset: samples: 1 is not allowed", "1 to train on and 0 to valid"]),
    (STUDY, "trains_on", {"default": "many"}, ["trains_on.default", "'many'", "allowed: default"]),
    (STUDY, "trains_on", {"other": "default"}, ["trains_on", "'other'", "allowed: data_free, default"]),
    (
        STUDY,
        "evaluation.learned_load.dataset",
        "many",
        ["evaluation.learned_load.dataset", "'many'", "allowed: default"],
    ),
    (STUDY, "further_datasets", {"many": {}}, ["further_datasets.many.seed", "2024", "another seed"]),
    (STUDY, "further_datasets", {"default": {"seed": 1}}, ["further_datasets", "'default'", "another name"]),
    (STUDY, "further_datasets", {"a b": {"seed": 1}}, ["further_datasets", "'a b'", "plain name"]),
    (STUDY, "evaluation.load", {**SPREAD, "to_m": 1.5}, ["evaluation.load: ", "1.5 m", "the span"]),
    (STUDY, "evaluation.load", {**SPREAD, "from_m": -1}, ["evaluation.load.from_m", "-1", "greater than"]),
    (STUDY, "evaluation.load", {"kind": "distributed"}, ["evaluation.load: along_x", "at least one"]),
    (STUDY, "evaluation.load.kind", "gust", ["evaluation.load.kind", "'gust'", "'tip_force'", "'several'"]),
    (STUDY, "evaluation.load", {"force_N": 1.0}, ["evaluation.load.kind: missing"]),
    (STUDY, "evaluation.load", [1], ["evaluation.load: [1] is not allowed; allowed: keys with values"]),
    (STUDY, "evaluation.load.direction", [0, 0, 1, 0], ["load.direction", "allowed: at most 3 values"]),
    (STUDY, "evaluation.load.force", 1.0, ["evaluation.load.force:", "did you mean 'force_N'"]),
    (STUDY, "evaluation.load", {**SPREAD, "acts_on": "root"}, ["load.acts_on", "'root'", "'span' or 'tip'"]),
    (
        STUDY,
        "evaluation.load",
        {**SPREAD, "along_z": {"force_N_m": 1.0, "shape": "oval"}},
        ["evaluation.load.along_z.shape", "'oval'", "one_minus_elliptic"],
    ),
    (STUDY, "evaluation.load.direction", [0, 0, 0], ["evaluation.load: direction", "zero vector"]),
    (STUDY, "evaluation.load.direction", [0, 1, 0], ["evaluation.load: no joint feels it", "out_of_plane"]),
    (STUDY, "evaluation.load", {**PUSH, "force_N": 0.0}, ["evaluation.load: no joint feels it"]),
    (
        STUDY,
        "evaluation.load",
        {"kind": "several", "loads": [PUSH, {**PUSH, "direction": [0, 1, 0]}]},
        ["evaluation.load: loads[1]: no joint feels it"],
    ),
    (
        STUDY,
        "evaluation.load",
        {"kind": "several", "loads": [PUSH, {**PUSH, "force": 1}]},
        ["evaluation.load.loads[1].force", "unknown key"],
    ),
    (
        STUDY,
        "evaluation.load.history",
        {"kind": "table", "file": "no.csv"},
        ["history.file: 'no.csv'", "a CSV"],
    ),
    (STUDY, "evaluation.load.history", {"kind": "table"}, ["load.history: file, times_s: one of the two"]),
    (
        STUDY,
        "evaluation.load.history.frequency_rad_s",
        0.0,
        ["load.history.frequency_rad_s", "greater than 0"],
    ),
    (STUDY, "evaluation.load.history", {"kind": "cosine"}, ["load.history.kind", "'cosine'", "'power'"]),
    (
        STUDY,
        "evaluation.load.history.exponent",
        2,
        ["evaluation.load.history.exponent", "unknown key", "phase_rad"],
    ),
    (STUDY, "evaluation.load.history.end_s", -1.0, ["evaluation.load.history.end_s", "greater than 0"]),
    (STUDY, "evaluation.load.history.start_s", 7.0, ["longest_load_s: 5.0", "more than 7.0"]),
    (STUDY, "frequencies_also_of", ["absent.yaml"], ["frequencies_also_of", "absent.yaml", "no file"]),
    (STRUCTURE, "damping_torsion_s", -10.0, ["damping_torsion_s", "-10.0", "greater than or equal to 0"]),
    (STRUCTURE, "centre_of_gravity_offset_m", 0.2, ["centre_of_gravity_offset_m", "0.2", "chord", "0.1 m"]),
    (STUDY, "evaluation.integrators", [{"method": "rk5"}], ["integrators[0].method", "'rk5'", "rk4"]),
    (STUDY, "evaluation.integrators", [{"method": "rk4"}], ["integrators[0]", "takes step_s"]),
    (SWEEP, "spaces.0.activation", ["sigmoid"], ["activation[0]", "'sigmoid'", "tanh"]),
    (SWEEP, "spaces.0.activation", "tanh", ["spaces[0].activation", "'tanh'", "list"]),
    (SWEEP, "spaces.0.hidden", [], ["spaces[0].hidden", "[]", "at least one value"]),
    (SWEEP, "spaces.0.hidden", None, ["spaces[0].hidden", "without values"]),
    (SWEEP, "spaces.0.hiden", [[8]], ["spaces[0].hiden", "did you mean 'hidden'"]),
    (SWEEP, "spaces.0.architecture", "hmm", ["spaces[0].architecture", "'hmm'", "hnn"]),
    (SWEEP, "spaces.0.architecture", "hmm", ["my_models.py:MyField"]),
    (SWEEP, "spaces.0.architecture", "mine.py:Field", ["spaces[0].architecture", "no file mine.py below"]),
    (SWEEP, "spaces.0.architecture", "../mine.py:Field", ["spaces[0].architecture", "outside the project"]),
    (SWEEP, "spaces.1.optimiser", ["adam"], ["adam takes learning_rate and batch_size"]),
    (SWEEP, "spaces.1.degree", [4], ["spaces[1] (", "hidden: [", "degree does nothing with hnn"]),
    (SWEEP, "spaces", [], ["spaces", "[]", "at least one value"]),
    (SWEEP, "search", "random", ["draws: missing with search: random", "1 or more"]),
    (SWEEP, "draws", 5, ["draws: 5 is not allowed with search: grid", "random or sobol"]),
    (SWEEP, "search", "sobl", ["search", "'sobl'", "did you mean 'sobol'"]),
    (SWEEP, "seed", -1, ["seed", "-1", "0"]),
    (SWEEP, "spaces.0.degree", {"low": 2, "high": 6}, ["spaces[0].degree", "search is grid", "sobol"]),
    (SWEEP, "spaces.0.degree", {"low": 6, "high": 6}, ["spaces[0].degree", "low: 6", "below high, 6"]),
    (SWEEP, "spaces.0.degree", {"low": 0, "high": 6}, ["spaces[0].degree.low", "0", "1"]),
    (SWEEP, "spaces.0.degree", {"low": 2.5, "high": 6}, ["spaces[0].degree.low", "2.5", "integer"]),
    (SWEEP, "spaces.0.degree", {"low": 2, "hihg": 6}, ["spaces[0].degree.hihg", "did you mean 'high'"]),
    (SWEEP, "spaces.1.seed", {"low": 0, "high": 6, "scale": "log"}, ["spaces[1].seed", "above 0"]),
    (SWEEP, "spaces.1.hidden", {"low": [8], "high": 9}, ["spaces[1].hidden.low", "[8]", "integer"]),
    (SWEEP, "spaces.1.activation", {"low": 1, "high": 9}, ["spaces[1].activation", "list of values"]),
    (SWEEP, "spaces.1.give_up", [{"after_epochs": 5}], ["spaces[1].give_up[0].above_nmse", "missing"]),
    (SWEEP, "spaces.1.give_up", {"after_epochs": 5}, ["spaces[1].give_up", "list of values"]),
]


@pytest.mark.parametrize(("file", "keys", "value", "words"), BAD_VALUES)
def test_a_bad_value_is_refused_with_file_key_value_and_what_is_allowed(root, file, keys, value, words):
    if "torsional" in keys:
        change(root, STRUCTURE, "joints", ["out_of_plane", "torsion"])
    change(root, file, keys, value)
    message = refusal(root)
    assert all(word in message for word in [file, *words]), message
    assert "Traceback" not in message
    assert len(message.splitlines()) <= 2


@pytest.mark.parametrize("file", [CONFIG, STUDY, STRUCTURE, SWEEP])
@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("key: [1, 2", ["line 2", "is not YAML"]),
        ("a: 1\n\tb: 2", ["line 2", "is not YAML"]),
        ("just words", ["'just words'", "keys with values"]),
        ("", ["is empty", "keys with values"]),
        ("seed: 1\non: 2", ["line 2, column 1", "key 'on' is no text", "in quotes"]),
        ("dataset:\n  1: 2", ["line 2, column 3", "key '1' is no text"]),
        ("name: 2020-13-01", ["line 1, column 7", "2020-13-01 is a date"]),
        ("seed: 1\nseed: 2", ["line 2", "'seed' is given twice"]),
        ("elements: 010", ["line 1", "010 is no decimal number"]),
        ("elements: 1:10", ["line 1", "1:10 is no decimal number"]),
        ("length_m: -1:30.5", ["line 1", "-1:30.5 is no decimal number"]),
        ("name: !!python/name:os.system x", ["line 1", "is not YAML", "tag"]),
        ("seed: 1\n---\nseed: 2", ["line 2", "single document"]),
        ("seed: " + "9" * 5000, ["is not YAML", "digits"]),
    ],
)
def test_a_file_that_is_not_what_it_should_be_is_named(root, file, content, words):
    (root / file).write_text(content + "\n")
    message = refusal(root)
    assert all(word in message for word in [file, *words]), message


@pytest.mark.parametrize("file", [CONFIG, STUDY, STRUCTURE, SWEEP, "mine.py"])
def test_a_file_that_may_not_be_read_is_named(root, monkeypatch, file):
    """A superuser may read all files: hence a substitute for what reads them."""
    (root / "mine.py").touch()
    change(root, SWEEP, "spaces.0.architecture", "mine.py:Field")
    for name in ("read_text", "read_bytes"):
        monkeypatch.setattr(Path, name, _refusing(root / file, getattr(Path, name)))
    message = refusal(root)
    assert file in message
    assert "cannot be read: Permission denied" in message
    assert len(message.splitlines()) == 1


def _refusing(path, read):
    def refused(self, *arguments, **options):
        if self == path:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
        return read(self, *arguments, **options)

    return refused


def test_a_byte_order_mark_and_numbers_that_yaml_takes_for_text_are_read_as_they_look(root):
    path = root / STRUCTURE
    text = path.read_text().replace("mass_per_length_kg_m: 0.2", "mass_per_length_kg_m: 2e-1")
    path.write_text("\ufeff" + text)
    (study, *_) = load(root, [CONFIG]).studies
    assert study.structure.mass_per_length_kg_m == 0.2


@pytest.mark.parametrize("results", ["~/out", "${HOME}/out", "$HOME/in/../out"])
def test_results_may_lie_at_home_and_where_variables_say(root, monkeypatch, results):
    monkeypatch.setenv("HOME", str(root))
    change(root, CONFIG, "results", results)
    assert load(root, [CONFIG]).settings.results == f"{root}/out"


def test_results_where_nothing_may_be_written_are_refused(root, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: False)
    assert "results: 'results' is out of reach" in refusal(root)


def test_a_study_may_have_hyphens_in_its_name(root):
    shutil.copy(root / STUDY, root / "config/studies/soft-beam.yaml")
    change(root, CONFIG, "studies", ["soft-beam"])
    plan = Plan(load(root, [CONFIG]))
    assert plan.job("simulate", "soft-beam", "hamiltonian", "0")["study"] == "soft-beam"


def test_the_names_of_rules_are_those_of_the_snakefile():
    files = [REPOSITORY / "Snakefile", *(REPOSITORY / "workflow/rules").glob("*.smk")]
    text = "\n".join(file.read_text() for file in files)
    named = re.findall(r"^rule (\w+):", text, re.MULTILINE)
    begun = [f"{name}.+" for name in re.findall(r'name:\s+f"(\w+)\{study\}', text)]
    assert RULES.pattern.split("|") == sorted([*named, *begun])


def test_binary_rubbish_is_named(root):
    (root / STRUCTURE).write_bytes(b"\xff\xfe\x00\x01")
    assert f"{STRUCTURE}: is not text" in refusal(root)


def test_a_missing_key_is_named(root):
    content = yaml.safe_load((root / STRUCTURE).read_text())
    del content["length_m"]
    (root / STRUCTURE).write_text(yaml.safe_dump(content))
    assert f"{STRUCTURE}: length_m: missing" in refusal(root)


def test_every_problem_is_told_at_once(root):
    change(root, STRUCTURE, "length_m", -1.0)
    change(root, STRUCTURE, "elements", 0)
    change(root, SWEEP, "spaces.0.activation", ["sigmoid"])
    lines = refusal(root).splitlines()
    assert len(lines) == 3
    assert [line.split(":")[0] for line in lines] == [STRUCTURE, STRUCTURE, SWEEP]


def test_a_value_from_a_preset_is_blamed_on_the_preset(root):
    preset = "config/presets/mine.yaml"
    (root / preset).write_text("overrides: {cantilever: {dataset: {step_s: -1}}}\n")
    message = refusal(root, preset)
    assert message.startswith(f"{preset}: overrides.cantilever.dataset.step_s: -1 is not allowed")


@pytest.mark.parametrize(
    ("base", "words"),
    [
        ("wnig", ["'wnig' is no other study", "airliner, cantilever, crossover, damped"]),
        ("wing_unit", ["no other study"]),
    ],
)
def test_what_a_study_cannot_be_based_on_is_named(root, base, words):
    change(root, CONFIG, "studies", ["wing_unit"])
    change(root, "config/studies/wing_unit.yaml", "based_on", base)
    message = refusal(root)
    assert message.startswith("config/studies/wing_unit.yaml: based_on: ")
    for word in words:
        assert word in message


def test_a_value_of_the_base_is_blamed_on_the_base(root):
    change(root, CONFIG, "studies", ["wing_unit"])
    change(root, "config/studies/wing.yaml", "dataset.step_s", -1)
    assert refusal(root).startswith("config/studies/wing.yaml: dataset.step_s: -1 is not allowed")


def test_a_value_from_the_command_line_is_blamed_on_it(root):
    effective = yaml.safe_load((root / CONFIG).read_text()) | {"resutls": "x"}
    with pytest.raises(ConfigurationError, match="--config: resutls: unknown key"):
        load(root, [CONFIG], effective)
