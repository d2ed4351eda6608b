"""Names of studies, and folders with spaces in their names."""

import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest
from project import PRESET

from flexsurr.report.catalogue import FIGURES

REPOSITORY = Path(__file__).resolve().parents[2]
RECORDER = '#!/bin/sh\nprintf "%s\\n" "$@" >> "$(dirname "$0")/arguments"\n'


@pytest.fixture
def elsewhere():
    """A folder on another file system than the project's, where this machine has one that anybody may use."""
    shared = Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=shared if shared.is_dir() else None) as folder:
        yield Path(folder)


def test_a_study_with_a_hyphen_in_folders_with_spaces(make_project, elsewhere):
    """And with results behind a link, on another mount."""
    project = make_project()
    project.root = project.root.rename(project.root.with_name("a project"))
    shutil.copy(
        project.root / "config/studies/cantilever.yaml", project.root / "config/studies/soft-beam.yaml"
    )
    project.change("config/config.yaml", "studies", ["soft-beam"])
    project.change(PRESET, "results", "my results")
    (project.root / "my results").symlink_to(elsewhere)
    project.run_well("my results/evaluation/soft-beam/statics.parquet")
    assert (elsewhere / "evaluation/soft-beam/statics.parquet").is_file()


def test_a_study_is_a_target_and_no_other_study_is_made_for_it(make_project):
    project = make_project()
    scheduled = project.scheduled("wing")
    shown = project.plan.made_together("wing", FIGURES)
    assert {name for name in scheduled if name.startswith("draw_")} == {f"draw_wing_{made}" for made in shown}
    assert sum(map(len, shown.values())) == len(project.plan.figures("wing"))
    assert "fly" not in scheduled


@pytest.mark.parametrize(
    ("target", "tool", "argument"),
    [
        ("ui", "mlflow", "sqlite:///{root}/results/mlflow/mlflow.db"),
        ("ui", "mlflow", "127.0.0.1"),  # on loopback, and nowhere else
        ("reproduce", "snakemake", "--cores"),
    ],
)
def test_make_in_a_folder_with_spaces(tmp_path, target, tool, argument):
    """What make runs is recorded in place of the tool itself, an argument a line."""
    root = tmp_path / "a project"
    tools = root / ".venv/bin"
    tools.mkdir(parents=True)
    (root / "results/mlflow").mkdir(parents=True)
    (root / "results/mlflow/mlflow.db").touch()
    for name in ("Makefile", "environment.txt", "pyproject.toml"):
        shutil.copy(REPOSITORY / name, root)
    (tools / tool).write_text(RECORDER)
    (tools / tool).chmod(0o755)
    (root / ".venv/.installed").touch()
    subprocess.run(["make", target], cwd=root, check=True, capture_output=True, timeout=60)
    assert argument.format(root=root) in (tools / "arguments").read_text().splitlines()
