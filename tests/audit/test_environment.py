"""The pinned environment and the Python that the project promises to run on."""

import tomllib
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

PROJECT = Path(__file__).parents[2]


def pinned():
    lines = (PROJECT / "environment.txt").read_text().splitlines()
    requirements = (line.split("#")[0].strip() for line in lines)
    return [Requirement(line) for line in requirements if line and not line.startswith("-")]


def test_every_package_takes_the_oldest_python_that_is_promised():
    project = tomllib.loads((PROJECT / "pyproject.toml").read_text())["project"]
    (lower,) = SpecifierSet(project["requires-python"])
    oldest = f"{lower.version}.0"
    refusing = {}
    for requirement in pinned():
        if requirement.marker and not requirement.marker.evaluate():
            continue
        try:
            wanted = metadata(requirement.name).get("Requires-Python")
        except PackageNotFoundError:
            pytest.fail(f"environment.txt: {requirement.name} is not installed")
        if wanted and not SpecifierSet(wanted).contains(oldest):
            refusing[requirement.name] = wanted
    assert not refusing
