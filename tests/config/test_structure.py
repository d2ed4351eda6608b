"""A structure whose properties vary: its table, the file beside it, and what is said of mistakes."""

import pytest
import yaml

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.structure import BEFORE, Structure
from flexsurr.config.study_files import read_structure

BEAM = {
    "name": "taper",
    "length_m": 2.0,
    "elements": 4,
    "joints": ["out_of_plane", "torsion"],
    "bending_stiffness_out_of_plane_N_m2": 50.0,
    "torsional_stiffness_N_m2": 20.0,
    "torsional_inertia_per_length_kg_m": 0.01,
}
TABLE = {"stations_m": [0.0, 0.5, 2.0], "mass_per_length_kg_m": [0.4, 0.3, 0.1]}


def written(folder, values):
    path = folder / "taper.yaml"
    path.write_text(yaml.safe_dump(values))
    return path


def test_a_table_may_stand_in_the_file_or_in_a_csv_beside_it(tmp_path):
    inside = read_structure(written(tmp_path, {**BEAM, "along_span": TABLE}))
    (tmp_path / "table.csv").write_text(
        "# of a drawing\nstations_m, mass_per_length_kg_m\n0, 0.4\n0.5, 0.3\n\n2, 0.1\n"
    )
    beside = read_structure(written(tmp_path, {**BEAM, "along_span": {"file": "table.csv"}}))
    assert beside == inside
    assert Structure.model_validate(inside.model_dump(mode="json")) == inside


def with_table(**values):
    return {**BEAM, "along_span": {**TABLE, **values}}


@pytest.mark.parametrize(
    ("values", "parts"),
    [
        (BEAM, ["mass_per_length_kg_m: needed, here or in along_span"]),
        (
            with_table(stations_m=[0.0, 0.5, 1.5]),
            ["along_span: stations_m", "0 to 1.5 m", "allowed: 0 to 2 m"],
        ),
        (
            with_table(stations_m=[0.1, 0.5, 2.0]),
            ["along_span: stations_m", "0.1 to 2 m", "allowed: 0 to 2 m"],
        ),
        (
            with_table(stations_m=[0.0, 500.0, 2000.0]),
            ["along_span: stations_m", "0 to 2000 m", "allowed: 0 to 2 m"],
        ),
        (with_table(stations_m=[0.0, 0.5, 0.4]), ["along_span", "stations_m: 0.4 after 0.5", "ascending"]),
        (with_table(stations_m=[0.0, 2.0]), ["along_span", "mass_per_length_kg_m: 3 values", "allowed: 2"]),
        (
            with_table(mass_per_length_kg_m=[0.4, -0.3, 0.1]),
            ["along_span.mass_per_length_kg_m[1]", "-0.3", "greater than 0"],
        ),
        (with_table(mass=[1.0, 1.0, 1.0]), ["along_span.mass", "unknown key", "mass_per_length_kg_m"]),
        (
            {**with_table(), "mass_per_length_kg_m": 0.2},
            ["mass_per_length_kg_m: given here and in along_span", "one of the two"],
        ),
        (
            {**with_table(), "torsional_inertia_per_length_kg_m": 0.0},
            ["torsional_inertia_per_length_kg_m", "would move no mass"],
        ),
        (
            with_table(centre_of_gravity_offset_m=[0.0, 0.2, 0.0]),
            ["centre_of_gravity_offset_m: 0.2", "chord (0.1 m)"],
        ),
        (
            {**with_table(), "inertia_about_y_per_length_kg_m": 0.02},
            ["inertia_about_y_per_length_kg_m: 0.02", "at most as much"],
        ),
        (
            {**with_table(), "point_masses": [{"at_m": 3.0, "mass_kg": 1.0}]},
            ["point_masses[0].at_m: 3", "beyond the tip", "0 to 2"],
        ),
        (
            {**with_table(), "point_masses": [{"at_m": 1.0, "mass_kg": -1.0}]},
            ["point_masses[0].mass_kg", "-1.0", "greater than 0"],
        ),
        (
            {**with_table(), "point_masses": [{"at_m": 1.0, "mass_kg": 1.0, "inertia_kg_m2": [1, 0, 0]}]},
            ["point_masses[0]", "inertia_kg_m2", "is of no body"],
        ),
        (
            {**with_table(), "point_masses": [{"at_m": 1.0, "mass_kg": 1.0}], "rotary_inertia": "constant"},
            ["rotary_inertia: 'constant' is not allowed with point_masses"],
        ),
        ({**with_table(), "joint_rotation": "vectors"}, ["joint_rotation", "did you mean 'vector'"]),
    ],
)
def test_a_mistake_is_one_line_with_its_key(tmp_path, values, parts):
    assert_refused(written(tmp_path, values), parts)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        (None, ["table.csv: cannot be read"]),
        ("", ["table.csv: is empty"]),
        (
            "stations_m,mass_per_length\n0,1\n2,1\n",
            ["mass_per_length: unknown column", "'mass_per_length_kg_m'"],
        ),
        (
            "stations_m,mass_per_length_kg_m\n0,1\n2,heavy\n",
            ["line 3: mass_per_length_kg_m: 'heavy'", "a number"],
        ),
        ("stations_m,mass_per_length_kg_m\n0,1\n2\n", ["line 3: 1 values; allowed: 2"]),
        ("stations_m\n0,1\n2,1\n", ["1 names above 2 columns; allowed: one for each"]),
        ("stations_m,chord_m\n0,1\n2,1\n", ["mass_per_length_kg_m: needed"]),
        ("mass_per_length_kg_m\n1\n1\n", ["stations_m: 0 stations"]),
    ],
)
def test_so_is_one_in_a_csv_file(tmp_path, text, parts):
    if text is not None:
        (tmp_path / "table.csv").write_text(text)
    assert_refused(written(tmp_path, {**BEAM, "along_span": {"file": "table.csv"}}), parts)


def assert_refused(path, parts):
    with pytest.raises(ConfigurationError) as caught:
        read_structure(path)
    (line,) = caught.value.problems
    for part in (str(path.parent), *parts):
        assert part in line


def test_what_came_later_does_not_rename_what_was_before():
    before = Structure(**BEAM, mass_per_length_kg_m=0.2, joint_rotation="sequence", rotary_inertia="constant")
    assert Structure.model_validate(BEFORE | before.identity) == before
    later = {
        "along_span",
        "point_masses",
        "inertia_about_y_per_length_kg_m",
        "joint_rotation",
        "rotary_inertia",
    }
    assert set(before.identity) == set(Structure.model_fields) - later
    assert "joint_rotation" in before.model_copy(update={"joint_rotation": "vector"}).identity
