"""The wheel: it installs, and its command and library work outside the checkout."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from test_library import saved

from flexsurr.config.reference import reference
from flexsurr.training.saved_surrogate import save_surrogate

TOP = Path(__file__).parents[2]
PIP = (sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", "--no-input")


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A folder with what the wheel installs; its dependencies are those of the tests."""
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    source.mkdir()
    # a copy, for setuptools would take along whatever an earlier build has left beside the package
    shutil.copytree(TOP / "flexsurr", source / "flexsurr", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(TOP / name, source)
    run(folder, *PIP, "wheel", "--no-deps", "--no-build-isolation", "--no-index", "-w", folder, source)
    (wheel,) = folder.glob("*.whl")
    run(
        folder, *PIP, "install", "--no-deps", "--no-index", "--no-compile", "--target", folder / "site", wheel
    )
    shutil.rmtree(source)
    return folder / "site"


def run(folder, *command, path=""):
    done = subprocess.run(
        list(map(str, command)),
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(path), "XDG_CACHE_HOME": str(folder / "cache")},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_every_module_and_the_types_are_in_it(installed):
    def names(top):
        found = {path.relative_to(top) for path in top.rglob("*.py*")}
        return {path for path in found if "__pycache__" not in path.parts}

    assert names(installed / "flexsurr") == names(TOP / "flexsurr")
    assert (installed / "flexsurr" / "py.typed").is_file()


def test_the_command_works_elsewhere(installed, tmp_path):
    command = installed / "bin" / "flexsurr"
    assert run(tmp_path, command, "--help", path=installed).startswith("usage: flexsurr <command>")
    assert run(tmp_path, command, "reference", path=installed) == reference()


def test_a_surrogate_is_loaded_elsewhere(installed, tmp_path):
    save_surrogate(saved(), tmp_path / "weights.npz")
    ask = "import flexsurr; print(flexsurr.__file__); print(flexsurr.load_surrogate('weights.npz'))"
    place, *told = run(tmp_path, sys.executable, "-c", ask, path=installed).splitlines()
    assert Path(place).is_relative_to(installed)
    assert (
        told
        == run(
            tmp_path, installed / "bin" / "flexsurr", "surrogate", "weights.npz", path=installed
        ).splitlines()
    )
    assert "stands for strip: 1 m, 4 elements" in "\n".join(told)
