"""The quick preset run once, for all tests that look at what it makes or start from it."""

import shutil
from pathlib import Path

import pytest
from project import Project

REPOSITORY = Path(__file__).resolve().parents[2]
PARTS = ("Snakefile", "workflow", "profiles", "config", "examples")
STATE = ("results", ".snakemake")


@pytest.fixture(scope="session")
def make_project(tmp_path_factory):
    """Copies of the project; what still runs in them at the end is ended.

    They run the code of the repository itself, whose kernels need not be compiled again.
    """
    made: list[Project] = []

    def make(start_from: Project | None = None) -> Project:
        """A new project, or one that is where `start_from` has come to."""
        root = tmp_path_factory.mktemp("project")
        for part in (*PARTS, *STATE) if start_from else PARTS:
            source = (start_from.root if start_from else REPOSITORY) / part
            copy = shutil.copytree if source.is_dir() else shutil.copy2
            copy(source, root / part)
        made.append(Project(root, REPOSITORY))
        return made[-1]

    yield make
    for project in made:
        project.stop()


@pytest.fixture(scope="session")
def quick(make_project) -> Project:
    """The whole quick preset with its report. Read only: tests that change something take a copy."""
    project = make_project()
    project.run_well()
    project.run_well("--report", "results/report.html")
    return project


@pytest.fixture
def copy_of_quick(quick, make_project) -> Project:
    """The finished quick preset, free to be changed."""
    return make_project(quick)
