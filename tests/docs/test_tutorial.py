"""The tutorial does what it says: its blocks run one after another in a clean copy of the repository."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

TOP = Path(__file__).parents[2]
TUTORIAL = (TOP / "docs" / "tutorial.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", TUTORIAL, re.MULTILINE | re.DOTALL)
MADE = ("strip.csv", "strip.png", "shaken.png", "gust.gif")


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """What a clone holds of it, with `flexsurr`, `python` and `snakemake` as this test runs them."""
    root = tmp_path_factory.mktemp("clone")
    shutil.copy(TOP / "Snakefile", root)
    for folder in ("config", "workflow"):
        shutil.copytree(TOP / folder, root / folder)
    commands = root / "commands"
    commands.mkdir()
    for name, call in {"flexsurr": "-m flexsurr", "snakemake": "-m snakemake", "python": ""}.items():
        (commands / name).write_text(f'#!/bin/sh\nexec {sys.executable} {call} "$@"\n')
        (commands / name).chmod(0o755)
    return root


def run(clone, *command):
    environment = os.environ | {"PATH": f"{clone / 'commands'}:{os.environ['PATH']}", "PYTHONPATH": str(TOP)}
    return subprocess.run(
        command, cwd=clone, env=environment, capture_output=True, text=True, timeout=1800, check=False
    )


def test_its_blocks_run_one_after_another(clone):
    said = ""
    for kind, text in BLOCKS:
        if kind == "yaml":
            path = clone / text.splitlines()[0].removeprefix("# ")
            path.write_text(text)
        elif kind in ("sh", "python"):
            call = ("bash", "-euo", "pipefail", "-c", text) if kind == "sh" else ("python", "-c", text)
            done = run(clone, *call)
            assert done.returncode == 0, f"{text}\n{done.stdout[-2000:]}{done.stderr[-5000:]}"
            assert "Warning" not in done.stderr, done.stderr
            said = done.stdout
        elif kind == "text":
            assert said == text
    assert {kind for kind, _ in BLOCKS} == {"console", "sh", "yaml", "text", "python"}
    for name in MADE:
        assert (clone / name).stat().st_size > 1000


def test_what_sets_it_up_is_in_the_makefile():
    (set_up,) = (text for kind, text in BLOCKS if kind == "console")
    (target,) = re.findall(r"^make (\w+)$", set_up, re.MULTILINE)
    assert re.search(rf"^{target}: \$\(INSTALLED\)$", (TOP / "Makefile").read_text(), re.MULTILINE)


def test_its_exit_codes_are_those_that_help_explains(clone):
    documented = re.findall(r"^\| (\d+) \| ([^|;]+?) *(?:;[^|]*)?\|$", TUTORIAL, re.MULTILINE)
    assert len(documented) == 5
    told = run(clone, "flexsurr", "--help").stdout
    for code, meaning in documented:
        assert re.search(rf"^  {code} +{re.escape(meaning)}", told, re.MULTILINE)
