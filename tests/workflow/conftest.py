"""The quick preset run once, for all tests that look at what it makes or start from it."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest
import yaml

from flexsurr.config.settings import load
from flexsurr.workflow.plan import Plan

REPOSITORY = Path(__file__).resolve().parents[2]
CONFIGURATION = ("config/config.yaml", "config/presets/quick.yaml")
PARTS = ("Snakefile", "workflow", "profiles", "config", "flexsurr", "pyproject.toml")
STRAY = shutil.ignore_patterns("__pycache__", ".ruff_cache")


@dataclass
class Project:
    """A copy of the project in which a test may do as it likes."""

    root: Path
    started: list[subprocess.Popen] = field(default_factory=list)

    @property
    def results(self) -> Path:
        return self.root / "results"

    @property
    def plan(self) -> Plan:
        return Plan(load(self.root, CONFIGURATION))

    @property
    def command(self) -> list[str]:
        return [sys.executable, "-m", "snakemake", "--cores", "2", "--configfile", CONFIGURATION[1]]

    def start(self, *options: str) -> subprocess.Popen:
        """Snakemake in a session of its own, as a terminal would run it; its output goes to a file."""
        with (self.root / "snakemake.out").open("w") as output:
            process = subprocess.Popen(
                [*self.command, *options],
                cwd=self.root,
                env=os.environ | {"PYTHONPATH": str(self.root)},
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        self.started.append(process)
        return process

    def run(self, *options: str) -> tuple[int, str]:
        """Run Snakemake to its end: exit code and everything it printed."""
        code = self.start(*options).wait(timeout=600)
        return code, (self.root / "snakemake.out").read_text()

    def run_well(self, *options: str) -> str:
        """Run Snakemake, which must succeed."""
        code, output = self.run(*options)
        assert code == 0, output[-5000:]
        return output

    def scheduled(self, *options: str) -> dict[str, int]:
        """How many jobs of each rule a run would start; the target itself is left out."""
        return counted(self.run_well("--dry-run", *options))

    def change(self, file: str, keys: str, value: object) -> None:
        """Set the value at dotted `keys` of a YAML file; numbers are places in lists."""
        path = self.root / file
        content = yaml.safe_load(path.read_text())
        inner = content
        *above, last = [int(key) if key.isdigit() else key for key in keys.split(".")]
        for key in above:
            inner = inner.setdefault(key, {}) if isinstance(inner, dict) else inner[key]
        inner[last] = value
        path.write_text(yaml.safe_dump(content))

    def stop(self) -> None:
        """End whatever of this project still runs."""
        for process in self.started:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def counted(output: str) -> dict[str, int]:
    """The table "Job stats" of a dry run, without the target `all` and the sum."""
    jobs = {}
    for line in output.partition("Job stats:")[2].splitlines()[3:]:
        match = re.fullmatch(r"(\w+)\s+(\d+)", line.strip())
        if match is None or match[1] == "total":
            break
        jobs[match[1]] = int(match[2])
    jobs.pop("all", None)
    return jobs


def eventually(happens: Callable[[], bool], within_s: float = 120.0) -> None:
    """Wait until something is so."""
    end = time.monotonic() + within_s
    while not happens():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.05)


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
