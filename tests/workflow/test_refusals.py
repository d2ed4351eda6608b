"""Bad configuration ends Snakemake with a line that says what is wrong, before any job."""

import pytest


@pytest.mark.parametrize(
    ("file", "keys", "value", "message"),
    [
        (
            "config/structures/cantilever.yaml",
            "length_mm",
            1000,
            "config/structures/cantilever.yaml: length_mm: unknown key (value 1000); did you mean 'length_m'",
        ),
        (
            "config/presets/quick.yaml",
            "overrides.cantilever.dataset.step_s",
            -1,
            "config/presets/quick.yaml: overrides.cantilever.dataset.step_s: -1 is not allowed; "
            "allowed: greater than 0",
        ),
        (
            "config/sweeps/quick.yaml",
            "spaces.0.activation",
            ["sigmoid"],
            "config/sweeps/quick.yaml: spaces[0].activation[0]: 'sigmoid' is not allowed",
        ),
    ],
)
def test_a_bad_value_starts_nothing(make_project, file, keys, value, message):
    project = make_project()
    project.change(file, keys, value)
    code, output = project.run()
    assert code != 0
    assert message in output
    assert "Traceback" not in output
    assert not project.results.exists()


@pytest.mark.parametrize("file", ["config/config.yaml", "config/sweeps/quick.yaml"])
def test_a_file_that_is_not_yaml_starts_nothing(make_project, file):
    project = make_project()
    (project.root / file).write_text("spaces: [1, 2\n")
    code, output = project.run()
    assert code != 0
    assert f"{file}, line 2" in output
    assert "is not YAML" in output
    assert "Traceback" not in output
    assert not project.results.exists()
