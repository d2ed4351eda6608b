"""What a contributor is told to run is what is run."""

import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import pytest
import yaml

import flexsurr

TOP = Path(__file__).parents[2]


def recipe(target: str) -> list[str]:
    """The commands of a target of the Makefile."""
    found = re.search(rf"^{target}:.*\n((?:\t.*\n)+)", (TOP / "Makefile").read_text(), re.MULTILINE)
    assert found is not None
    return [line.strip() for line in found[1].splitlines()]


def test_hooks_before_a_commit_run_what_make_check_runs():
    hooks = yaml.safe_load((TOP / ".pre-commit-config.yaml").read_text())["repos"]
    assert [repo["repo"] for repo in hooks] == ["local"]
    entries = [hook["entry"] for hook in hooks[0]["hooks"]]
    first = re.findall(r"^check: \$\(INSTALLED\) (.*)$", (TOP / "Makefile").read_text(), re.MULTILINE)
    assert entries == [
        *(f".venv/bin/{line}" for line in recipe("check")),
        *(f"make --silent {x}" for x in first),
    ]
    assert all(hook["language"] == "system" for hook in hooks[0]["hooks"])


CHECKS = ("ruff", "snakefmt", "mypy", "lint-imports")


@pytest.mark.parametrize("failing", ["", *CHECKS, "python"])
def test_what_a_check_finds_beside_the_tests_ends_make_test(tmp_path, failing):
    """Stand-ins of the tools say their names, and one of them fails."""
    tools = tmp_path / ".venv/bin"
    tools.mkdir(parents=True)
    for name in ("Makefile", "environment.txt", "pyproject.toml"):
        shutil.copy(TOP / name, tmp_path)
    (tmp_path / ".venv/.installed").touch()
    for tool in ("snakemake", "python", *CHECKS):
        (tools / tool).write_text(f"#!/bin/sh\necho {tool} says\nexit {int(tool == failing)}\n")
        (tools / tool).chmod(0o755)
    done = subprocess.run(
        ["make", "--no-print-directory", "test"], cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    said = done.stdout.splitlines()
    assert (done.returncode == 0) == (failing == "")
    assert said[0] == "python says"
    assert (f"{failing} says" in said[1:]) == (failing in CHECKS)


def test_make_help_has_every_target():
    (phony,) = re.findall(r"^\.PHONY: (.*)$", (TOP / "Makefile").read_text(), re.MULTILINE)
    told = set(re.findall(r"make ([\w-]+)", " ".join(recipe("help"))))
    assert set(phony.split()) - told == {"help", "browser", "postgresql", "slurm", "compiler"}


def test_the_changelog_begins_with_what_is_not_released_and_has_the_version():
    titles = re.findall(r"^## (.*)$", (TOP / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert titles[0] == "Unreleased"
    assert titles[1].split()[0] == flexsurr.__version__


def test_no_two_files_of_tests_share_a_name():
    """By it alone are they imported."""
    names = Counter(path.name for path in (TOP / "tests").rglob("*.py") if path.name != "conftest.py")
    assert [name for name, count in names.items() if count > 1] == []
