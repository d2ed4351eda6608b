"""The quick preset run once, for all tests that look at what it makes or start from it."""

import shutil
from pathlib import Path

import pytest
from project import Project

REPOSITORY = Path(__file__).resolve().parents[2]
PARTS = ("Snakefile", "workflow", "profiles", "config", "flexsurr", "pyproject.toml")
STRAY = shutil.ignore_patterns("__pycache__", ".ruff_cache")


@pytest.fixture(scope="session")
def make_project(tmp_path_factory):
    """Copies of the project; what still runs in them at the end is ended."""
    made: list[Project] = []

    def make(start_from: Path | None = None) -> Project:
        root = tmp_path_factory.mktemp("project")
        if start_from is not None:
            shutil.copytree(start_from, root, dirs_exist_ok=True, symlinks=True)
        else:
            for part in PARTS:
                source = REPOSITORY / part
                copy = shutil.copytree if source.is_dir() else shutil.copy2
                copy(source, root / part, **({"ignore": STRAY} if source.is_dir() else {}))
        made.append(Project(root))
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
    return make_project(start_from=quick.root)
