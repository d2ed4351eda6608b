"""docs/own-network.md, block by block: its files make a study, and its Python runs."""

import re
import shutil
import textwrap
from pathlib import Path

import pytest

from flexsurr.config.settings import load
from flexsurr.workflow.plan import Plan

TOP = Path(__file__).parents[2]
TEXT = (TOP / "docs" / "own-network.md").read_text(encoding="utf-8")
FILES = ("my_models.py", "config/sweeps/mine.yaml", "config/studies/mine.yaml", "mine.yaml")


def blocks() -> list[str]:
    """The indented blocks of the document, those of list items too."""
    found = re.findall(r"(?:^(?: {4}[^\n]*)?\n)+", TEXT, re.MULTILINE)
    return [textwrap.dedent(block).strip("\n") for block in found if block.strip()]


def written_files() -> dict[str, str]:
    """The content of each file that the document writes, by the path in its first line."""
    parts = [part for block in blocks() for part in re.split(r"\n\n(?=# \S+\n)", block)]
    return {part.split("\n")[0].removeprefix("# "): part for part in parts if part.startswith("# ")}


@pytest.fixture
def project(tmp_path, monkeypatch):
    shutil.copytree(TOP / "config", tmp_path / "config")
    for file in FILES:
        (tmp_path / file).write_text(written_files()[file] + "\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_its_files_make_a_study(project):
    plan = Plan(load(project, ["config/config.yaml", "mine.yaml"]))
    named = [run.trial.architecture for run in plan.runs.values()]
    assert named.count("my_models.py:MyField") == 3
    assert named.count("hnn") == 1


def test_its_python_runs(project, capsys):
    (code,) = [block for block in blocks() if block.startswith("import numpy as np")]
    exec(compile(code, "own-network.md", "exec"), {})
    status, nmse = capsys.readouterr().out.split("\n")[0].split()
    assert status == "finished"
    assert float(nmse) < 1e-3
