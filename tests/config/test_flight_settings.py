"""How a study of samples flies: read whole, and refused by name."""

from pathlib import Path

import pytest
import yaml

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.settings import load
from flexsurr.config.sources import ResolvedSampleStudy

REPOSITORY = Path(__file__).resolve().parents[2]
STUDY = "config/studies/airliner.yaml"


def airliner(root: Path) -> ResolvedSampleStudy:
    (root / "config/config.yaml").write_text("studies: [airliner]\n")
    (study,) = load(root, ["config/config.yaml"]).studies
    assert isinstance(study, ResolvedSampleStudy)
    return study


BAD_VALUES = [
    ("condition.mach", 0.95, ["condition.mach", "0.95", "less than 0.95"]),
    ("condition.mach", -0.1, ["condition.mach", "-0.1", "greater than 0"]),
    ("envelope_mach", [0.7, 1.2], ["envelope_mach[1]", "1.2", "less than 0.95"]),
    ("envelope_mach", [], ["envelope_mach", "at least one"]),
    ("limits.alpha_deg", [10.0, -5.0], ["limits.alpha_deg", "10.0", "-5.0"]),
    ("limits.flaps_deg", [0.0, 5.0], ["limits.flaps_deg", "unknown key", "alpha_deg"]),
    ("doublet.middle_s", 3.0, ["doublet", "0.5, 3.0, 2.5", "allowed: increasing"]),
    ("aerodynamic_modes", [1, 2, 9], ["aerodynamic_modes", "mode 9", "1 to elastic_modes = 8"]),
    ("doublet.end_s", 50.0, ["doublet.end_s: 50 is not allowed", "less than duration_s: 5"]),
    ("aerodynamic_modes", [1, 1], ["aerodynamic_modes: 1 more than once", "each at most once"]),
    ("aerodynamic_modes", [1] * 7, ["aerodynamic_modes", "allowed: at most 6 values"]),
    ("limits.alpha_deg", [-5.0, 0.0, 10.0], ["limits.alpha_deg", "allowed: at most 2 values"]),
    ("random_flights.least_deg", -1.0, ["random_flights.least_deg", "-1.0", "greater than or equal to 0"]),
    ("random_flights.least_deg", 90.0, ["random_flights.least_deg: 90 is not allowed", "'s limit"]),
    ("random_flights.mach", [0.6, 0.7], ["random_flights.mach", "unknown key"]),
    ("random_flights.of_each_doublet", 0, ["of_each_doublet", "0", "greater than or equal to 1"]),
    ("step_s", 0.003, ["duration_s: 5 ", "step_s: 0.003", "such as 5.001"]),
    ("step_s", 7.0, ["duration_s: 5 ", "step_s: 7", "such as 7"]),
    ("step_s", "fast", ["step_s", "'fast'", "number"]),
]


def test_the_flights_of_the_study(root: Path):
    settings = airliner(root).study.flight
    assert (settings.condition.mach, settings.condition.altitude_m) == (0.7, 10000.0)
    assert settings.aerodynamic_modes == (1, 2, 5, 6, 7, 8)
    assert settings.random_flights.of_each_doublet == 30


@pytest.mark.parametrize(("keys", "value", "words"), BAD_VALUES)
def test_a_mistake_is_one_line(root: Path, keys: str, value: object, words: list[str]):
    content = yaml.safe_load((root / STUDY).read_text())
    inner = content["flight"]
    *steps, last = keys.split(".")
    for step in steps:
        inner = inner[step]
    inner[last] = value
    (root / STUDY).write_text(yaml.safe_dump(content))
    with pytest.raises(ConfigurationError) as caught:
        airliner(root)
    (problem,) = caught.value.problems
    assert problem.startswith(f"{STUDY}: flight")
    for word in words:
        assert word in problem


def test_a_lattice_has_a_strip_for_each_part_of_the_span(root: Path):
    """Of the wing's three sections the aileron divides the outermost in three."""
    content = yaml.safe_load((root / STUDY).read_text())
    content.setdefault("dataset", {})["panels"] = {"wing": [4, 5]}
    (root / STUDY).write_text(yaml.safe_dump(content))
    with pytest.raises(ConfigurationError, match=r"dataset\.panels\.wing: 4 strips for 5 parts of the span"):
        airliner(root)
