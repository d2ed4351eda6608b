"""What all tests share."""

import shutil
from functools import cache
from pathlib import Path

import pytest
from hypothesis import settings

# Machines that test are slow at times: an example's time says nothing here. The same examples each time:
# who tests a change shall not meet what chance finds elsewhere. To look further: --hypothesis-profile=search
settings.register_profile("flexsurr", deadline=None, derandomize=True)
settings.register_profile("search", deadline=None, print_blob=True, max_examples=1000)
settings.load_profile("flexsurr")

REPOSITORY = Path(__file__).parents[1]


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A copy of the configuration and of the examples that it reads; a test may change it."""
    for folder in ("config", "examples"):
        shutil.copytree(REPOSITORY / folder, tmp_path / folder)
    return tmp_path


LONG = (
    "workflow/test_slurm.py",
    "docs/test_tutorial.py",
    "workflow/test_own_data.py",
    "workflow/test_study_of_the_tapered_wing.py",
    "workflow/test_numbers_of_modes.py",
    "tracking/test_servers.py",
    "training/test_exported_networks.py",
    "training/test_derivatives.py",
    "workflow/test_interruptions.py",
    "workflow/test_changes.py",
    "workflow",
)
"""What takes long: the first makes the quick preset, and none has need of it up to the interruptions."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The long ones first: what is left at the end is short, and no core waits for another."""
    tests = Path(__file__).parent

    @cache
    def place(path: Path) -> int:
        return next((n for n, long in enumerate(LONG) if path.is_relative_to(tests / long)), len(LONG))

    items.sort(key=lambda item: place(item.path))
