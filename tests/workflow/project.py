"""A copy of the project in which tests run the workflow."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import forked_snakemake
import yaml

from flexsurr.config.settings import load
from flexsurr.workflow.plan import Plan

PRESET = "config/presets/quick.yaml"
CONFIGURATION = ("config/config.yaml", PRESET)
ALWAYS = ("--configfile", PRESET, "--cores", "2")
SAID = "snakemake.out"
NOWHERE = "http://127.0.0.1:9"
"""A tracking server that nobody runs: nothing listens there, which is known at once."""


@dataclass
class Project:
    """A copy of the project in which a test may do as it likes."""

    root: Path
    code: Path  # the folder whose flexsurr it runs
    started: list[subprocess.Popen] = field(default_factory=list)

    @property
    def results(self) -> Path:
        return self.root / "results"

    @property
    def plan(self) -> Plan:
        return Plan(load(self.root, CONFIGURATION))

    def start(self, *options: str, said: str = SAID) -> subprocess.Popen:
        """Snakemake in a session of its own, as a terminal would run it; its output goes to `said`."""
        with (self.root / said).open("w") as output:
            process = subprocess.Popen(
                [sys.executable, "-m", "snakemake", *ALWAYS, *options],
                cwd=self.root,
                env=os.environ | {"PYTHONPATH": str(self.code)},
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=_heed_ctrl_c,
            )
        self.started.append(process)
        return process

    def run(self, *options: str, said: str = SAID) -> tuple[int, str]:
        """Run Snakemake to its end: exit code and everything it printed."""
        code = forked_snakemake.run([*ALWAYS, *options], self.root, self.code, self.root / said)
        return code, (self.root / said).read_text()

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

    def tell_no_page(self) -> None:
        """Make results without a page of runs, where no test looks at it: it takes seconds of each run."""
        self.change("config/config.yaml", "tracking.uri", NOWHERE)

    def stop(self) -> None:
        """End whatever of this project still runs."""
        for process in self.started:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def _heed_ctrl_c() -> None:
    """A test run in the background ignores SIGINT, and so would its children."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


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


def eventually(happens: Callable[[], bool], within_s: float = 600.0) -> None:
    """Wait until something is so."""
    end = time.monotonic() + within_s
    while not happens():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.05)
