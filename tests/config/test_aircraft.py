"""The airliner's file: read whole, and refused by name where it contradicts itself."""

import shutil
from pathlib import Path

import pytest
import yaml

from flexsurr.config.aircraft import load_aircraft
from flexsurr.config.errors import ConfigurationError

GNBA = Path(__file__).resolve().parents[2] / "config/aircraft/gnba.yaml"
SHOWN = "config/aircraft/gnba.yaml"


def test_the_airliner_has_its_published_mass_and_span():
    aircraft = load_aircraft(GNBA)
    assert aircraft.mass.total_kg == 55764.0
    assert aircraft.stiffness.wing_crank_to_tip.elements == 25
    assert aircraft.stiffness.fuselage.values[0] == (1.08e9, 6.6e8, 6.6e8, 3.31e8)


def test_every_block_names_its_source():
    content = yaml.safe_load(GNBA.read_text())
    assert content["mass"]["source"] == content["aerodynamics"]["source"] == "assumed"
    for block in ("published", "reference", "control_surfaces", "fuselage", "stiffness"):
        assert content[block]["source"], block
    assert {surface["source"] for surface in content["surfaces"].values()} == {"transcribed"}


ABSENT = object()
BAD_VALUES = [
    ("surfaces.wing", ABSENT, ["surfaces.wing", "missing"]),
    ("surfaces.horizontal_tail", ABSENT, ["surfaces.horizontal_tail", "missing"]),
    ("surfaces.canard", {}, ["surfaces.canard", "unknown key", "vertical_tail"]),
    ("control_surfaces.rudder.surface", "fin", ["control_surfaces.rudder.surface", "'fin'", "vertical_tail"]),
    ("control_surfaces.aileron.surface", "vertical_tail", ["aileron", "left and a right half", "wing"]),
    ("control_surfaces.rudder", ABSENT, ["control_surfaces.rudder", "missing"]),
    ("control_surfaces.spoiler", {}, ["control_surfaces.spoiler", "unknown key", "aileron"]),
    ("control_surfaces.aileron.span", [0.9, 0.7], ["control_surfaces.aileron", "0.9", "0.7"]),
    (
        "control_surfaces.aileron.hinge",
        1.0,
        ["control_surfaces.aileron.hinge", "1.0", "less than 1"],
    ),
    (
        "control_surfaces.aileron.surface",
        "horizontal_tail",
        [
            "control_surfaces: aileron.surface: horizontal_tail has the elevator already",
            "one control surface",
        ],
    ),
    ("surfaces.wing.elastic_axis", [0.3, 0.4], ["surfaces: wing.elastic_axis: 2 values", "one, or 3"]),
    ("surfaces.vertical_tail.beam_starts_at_m", 99.0, ["vertical_tail.beam_starts_at_m: 99", "up to"]),
    ("mass.fuel_kg", 12000.0, ["mass", "56764", "55764"]),
    ("mass.fuel_kg", "eleven tons", ["mass.fuel_kg", "'eleven tons'", "number"]),
    ("mass.engine.mass_kg", -2900.0, ["mass.engine.mass_kg", "-2900.0", "greater than 0"]),
    ("mass.payload.x_m", [31.0, 5.0], ["mass.payload", "31.0", "5.0"]),
    ("mass.payload.x_m", [5.0, 310.0], ["mass", "310", "39.15"]),
    (
        "stiffness.fuselage.axial_stiffness_N.3",
        -1.61e9,
        ["stiffness.fuselage.axial_stiffness_N[3]", "-1610000000.0", "greater than 0"],
    ),
    (
        "stiffness.horizontal_tail.torsional_stiffness_N_m2",
        [1.0e7, 2.0e7],
        ["stiffness.horizontal_tail", "torsional_stiffness_N_m2", "2 values", "9"],
    ),
    ("stiffness.connections.pylon.torsional_stiffness_N_m2", 0.0, ["pylon.torsional_stiffness_N_m2", "0.0"]),
    ("surfaces.wing.sections.1.chord_m", [5.0, 3.836], ["surfaces.wing", "sections[1]", "5.0", "6.03"]),
    ("surfaces.wing.sections.2.length_m", 11.0, ["surfaces.wing.sections", "span", "32.756"]),
    ("surfaces.wing.swep", 3.0, ["surfaces.wing.swep", "unknown key", "sections"]),
    ("surfaces", 3, ["surfaces", "3", "keys with values"]),
    ("structural_damping_ratio", 1.0, ["structural_damping_ratio", "1.0", "less than 1"]),
    ("structural_damping_ratio", True, ["structural_damping_ratio", "truth value"]),
]


@pytest.mark.parametrize(("keys", "value", "words"), BAD_VALUES)
def test_a_mistake_is_one_line_with_file_key_and_value(
    tmp_path: Path, keys: str, value: object, words: list[str]
):
    path = tmp_path / "gnba.yaml"
    content = yaml.safe_load(GNBA.read_text())
    inner = content
    *steps, last = [int(key) if key.isdigit() else key for key in keys.split(".")]
    for step in steps:
        inner = inner[step]
    if value is ABSENT:
        del inner[last]
    else:
        inner[last] = value
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(ConfigurationError) as caught:
        load_aircraft(path, SHOWN)
    (problem,) = caught.value.problems
    assert problem.startswith(f"{SHOWN}: ")
    assert "\n" not in problem
    for word in words:
        assert word in problem


def test_a_file_that_is_not_there_is_named(tmp_path: Path):
    with pytest.raises(ConfigurationError, match=r"absent\.yaml: no such file"):
        load_aircraft(tmp_path / "absent.yaml")


def test_every_problem_is_reported_at_once(tmp_path: Path):
    path = tmp_path / "gnba.yaml"
    shutil.copy(GNBA, path)
    path.write_text(
        path.read_text().replace("fuel_kg: 11000.0", "fuel_kg: -1.0").replace("hinge: 0.80", "hinge: 8")
    )
    with pytest.raises(ConfigurationError) as caught:
        load_aircraft(path)
    assert len(caught.value.problems) == 2
