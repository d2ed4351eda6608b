"""The airliner's flight file: read whole, and refused by name."""

from pathlib import Path

import pytest
import yaml

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.flight import load_flight

FLIGHT = Path(__file__).resolve().parents[2] / "config/flight/airliner.yaml"

BAD_VALUES = [
    ("condition.mach", 0.95, ["condition.mach", "0.95", "less than 0.95"]),
    ("condition.mach", -0.1, ["condition.mach", "-0.1", "greater than 0"]),
    ("envelope_mach", [0.7, 1.2], ["envelope_mach[1]", "1.2", "less than 0.95"]),
    ("envelope_mach", [], ["envelope_mach", "at least one"]),
    ("limits.alpha_deg", [10.0, -5.0], ["limits.alpha_deg", "10.0", "-5.0"]),
    ("limits.flaps_deg", [0.0, 5.0], ["limits.flaps_deg", "unknown key", "alpha_deg"]),
    ("doublet.middle_s", 3.0, ["doublet", "0.5, 3.0, 2.5", "not increasing"]),
    ("aerodynamic_modes", [1, 2, 9], ["aerodynamic_modes", "mode 9", "1 to elastic_modes = 8"]),
    ("aerodynamic_modes", [1, 1], ["aerodynamic_modes", "at most once"]),
    ("random_flights.least_deg", -1.0, ["random_flights.least_deg", "-1.0", "greater than or equal to 0"]),
    ("random_flights.mach", [0.6, 0.7], ["random_flights.mach", "unknown key"]),
    ("random_flights.of_each_doublet", 0, ["of_each_doublet", "0", "greater than or equal to 1"]),
    ("step_s", 0.003, ["duration_s: 5 ", "step_s: 0.003", "such as 5.001"]),
    ("step_s", 7.0, ["duration_s: 5 ", "step_s: 7", "such as 7"]),
    ("step_s", "fast", ["step_s", "'fast'", "number"]),
    ("aircraft", 7, ["aircraft", "7", "string"]),
]


def test_the_flights_of_the_study():
    settings = load_flight(FLIGHT)
    assert (settings.condition.mach, settings.condition.altitude_m) == (0.7, 10000.0)
    assert settings.aerodynamic_modes == (1, 2, 5, 6, 7, 8)
    assert settings.random_flights.of_each_doublet == 30


@pytest.mark.parametrize(("keys", "value", "words"), BAD_VALUES)
def test_a_mistake_is_one_line(tmp_path: Path, keys: str, value: object, words: list[str]):
    content = yaml.safe_load(FLIGHT.read_text())
    inner = content
    *steps, last = keys.split(".")
    for step in steps:
        inner = inner[step]
    inner[last] = value
    path = tmp_path / "airliner.yaml"
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(ConfigurationError) as caught:
        load_flight(path, "config/flight/airliner.yaml")
    (problem,) = caught.value.problems
    assert problem.startswith("config/flight/airliner.yaml: ")
    for word in words:
        assert word in problem
