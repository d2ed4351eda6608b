"""The quick preset run once, for all tests that look at what it makes or start from it."""

import shutil
from pathlib import Path

import pytest
from project import PRESET, Project

from flexsurr.storage.files import locked

REPOSITORY = Path(__file__).resolve().parents[2]
PARTS = ("Snakefile", "workflow", "profiles", "config", "examples")
STATE = ("results", ".snakemake")


@pytest.fixture(scope="session")
def make_project(tmp_path_factory):
    """Copies of the project; what still runs in them at the end is ended.

    They run the code of the repository itself, whose kernels need not be compiled again.
    """
    made: list[Project] = []

    def make(start_from: Project | None = None, root: Path | None = None) -> Project:
        """A new project, or one that is where `start_from` has come to."""
        root = root or tmp_path_factory.mktemp("project")
        for part in (*PARTS, *STATE) if start_from else PARTS:
            source = (start_from.root if start_from else REPOSITORY) / part
            copy = shutil.copytree if source.is_dir() else shutil.copy2
            copy(source, root / part)
        made.append(Project(root, REPOSITORY))
        made[-1].change(PRESET, "results", "results")
        return made[-1]

    yield make
    for project in made:
        project.stop()


@pytest.fixture(scope="session")
def quick(make_project, tmp_path_factory, worker_id) -> Project:
    """The whole quick preset with its report. Read only: tests that run or change something take a copy.

    Of several workers the first makes it, while the others wait.
    """
    temporary = tmp_path_factory.getbasetemp()
    shared = (temporary if worker_id == "master" else temporary.parent) / "quick"
    with locked(shared):
        if (shared / "done").exists():
            return Project(shared / "project", REPOSITORY)
        (shared / "project").mkdir()
        project = make_project(root=shared / "project")
        project.run_well()
        project.run_well("--report", "results/report.html")
        (shared / "done").touch()
    return project


@pytest.fixture
def copy_of_quick(quick, make_project) -> Project:
    """The finished quick preset, free to be changed."""
    return make_project(quick)
