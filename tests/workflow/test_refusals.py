"""Bad configuration ends Snakemake with a line that says what is wrong, before any job.

Which values are bad, and what is said of each: tests/config/test_errors.py.
"""

import re


def is_refused(project, *said: str) -> None:
    code, output = project.run()
    assert code != 0
    assert all(words in output for words in said), output
    assert "Traceback" not in output
    assert not project.results.exists()


def test_a_bad_value_starts_nothing(make_project):
    project = make_project()
    project.change("config/sweeps/quick.yaml", "spaces.0.activation", ["sigmoid"])
    is_refused(project, "config/sweeps/quick.yaml: spaces[0].activation[0]: 'sigmoid' is not allowed")


def test_a_file_that_is_not_yaml_starts_nothing(make_project):
    """One that Snakemake reads itself, for it has the addresses of the studies."""
    project = make_project()
    (project.root / "config/config.yaml").write_text("spaces: [1, 2\n")
    is_refused(project, "config/config.yaml, line 2", "is not YAML")


def test_what_jobs_read_and_cannot_be_written_is_one_line(make_project):
    project = make_project()
    project.results.mkdir()
    (project.results / "jobs").touch()
    code, output = project.run()
    assert code == 1
    assert re.fullmatch(r"results/jobs/\w+: Not a directory", output.splitlines()[-1])
    assert "Traceback" not in output
