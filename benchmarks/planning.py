"""What planning a sweep costs, and running it: time, memory, files and jobs against numbers of tiny trials.

    python benchmarks/planning.py                  # up to 10,000 trials in batches, up to 1,000 in a job each
    python benchmarks/planning.py 5000 1000        # so many trials and shards, in batches and in a job each
    python benchmarks/planning.py --run 5000 1000  # planned, and then run in batches, on all cores

It plans (`snakemake --dry-run`) the cantilever of the quick preset up to its selection and its table of
training, in a copy of the configuration; `--run` makes them.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

import yaml
from timing import record

PROJECT = Path(__file__).resolve().parents[1]
PARTS = ("Snakefile", "workflow", "profiles", "config", "examples")
TARGETS = ("results/selected/cantilever.json", "results/tables/cantilever/training.html")
VARIANTS = 2
PRESET = "config/presets/many.yaml"
JOB_EACH = {"trials_per_job": 1, "shards_per_job": 1}
UNSAID = {"trials_per_job": None, "shards_per_job": None}


def sweep(trials: int) -> dict:
    """A sweep that makes so many trials of all variants together."""
    space = {
        "architecture": "hnn",
        "hidden": [[4]],
        "activation": ["tanh"],
        "optimiser": ["levenberg_marquardt"],
        "epochs": [1],
        "seed": list(range(trials // VARIANTS)),
    }
    return {"search": "grid", "spaces": [space]}


def prepare(root: Path, trials: int, shards: int, batches: dict[str, int | None]) -> None:
    """Write the configuration of a sweep of so many trials on datasets of so many shards."""
    for part in PARTS:
        source = PROJECT / part
        (shutil.copytree if source.is_dir() else shutil.copy2)(source, root / part)
    preset = yaml.safe_load((root / "config/presets/quick.yaml").read_text())
    study = preset["overrides"]["cantilever"]
    study["dataset"] |= {"trajectories": max(shards // VARIANTS, 2), "trajectories_per_shard": 1}
    study["sweeps"]["data_free"] = None
    values = {"results": "results", "batches": batches, "studies": ["cantilever"]}
    (root / PRESET).write_text(yaml.safe_dump(preset | values))
    (root / "config/sweeps/quick.yaml").write_text(yaml.safe_dump(sweep(trials)))


class Cost(NamedTuple):
    """Wall and processor seconds, and the memory of the largest process [MB]."""

    wall_s: float
    processor_s: float
    memory_MB: float

    def __str__(self) -> str:
        return f"{self.wall_s:>8.1f} {self.processor_s:>12.1f} {self.memory_MB:>7.0f}"


def snakemake(root: Path, *options: str) -> tuple[str, Cost]:
    """What Snakemake says in `root`, and what it and its jobs cost."""
    command = [sys.executable, "-m", "snakemake", *TARGETS, "--configfile", PRESET, *options]
    environment = os.environ | {"PYTHONPATH": str(PROJECT)}
    began = time.perf_counter()
    with (root / "said").open("w") as said:
        process = subprocess.Popen(command, cwd=root, env=environment, stdout=said, stderr=subprocess.STDOUT)
    _, status, used = os.wait4(process.pid, 0)
    cost = Cost(time.perf_counter() - began, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)
    process.returncode = os.waitstatus_to_exitcode(status)
    text = (root / "said").read_text()
    if process.returncode:
        raise RuntimeError(text[-2000:])
    return text, cost


def plan(root: Path) -> tuple[int, Cost]:
    """The number of jobs of a dry run in `root`, and its cost."""
    said, cost = snakemake(root, "--dry-run", "--quiet", "rules")
    jobs = re.search(r"^total\s+(\d+)", said, re.MULTILINE)
    assert jobs, said[-2000:]
    return int(jobs[1]), cost


def run(root: Path) -> tuple[int, float, Cost]:
    """The files that a run leaves in `root`, their size [MB], and its cost."""
    _, cost = snakemake(root, "--cores", "all")
    files = [path for path in (root / "results").rglob("*") if path.is_file()]
    return len(files), sum(path.stat().st_size for path in files) / 1e6, cost


def arguments() -> argparse.Namespace:
    """How many of what, and whether they run."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("trials", type=int, nargs="?", help="by default several numbers of them")
    parser.add_argument("shards", type=int, nargs="?", default=4, help="by default 4")
    parser.add_argument("--run", action="store_true", help="run them too, those in batches")
    return parser.parse_args()


def main() -> None:
    """Print a row for each number of trials, in batches and in a job each."""
    asked = arguments()
    if asked.trials:
        cases = [(asked.trials, asked.shards, batches) for batches in (UNSAID, JOB_EACH)]
    else:
        cases = [(count, asked.shards, UNSAID) for count in (100, 1_000, 10_000)]
        cases += [(count, asked.shards, JOB_EACH) for count in (100, 1_000)]
    if asked.run:
        cases = [case for case in cases if case[2] is UNSAID]
    taken: dict[str, dict[str, float | None]] = defaultdict(dict)
    more: dict[str, dict[str, dict[str, float | None]]] = defaultdict(dict)
    print("         trials  shards  batches    jobs   wall s  processor s      MB   files  MB of files")
    for trials, shards, batches in cases:
        case, size = (
            "in batches" if batches is UNSAID else "a job each",
            f"{trials} trials on {shards} shards",
        )
        with tempfile.TemporaryDirectory() as folder:
            prepare(Path(folder), trials, shards, batches)
            jobs, cost = plan(Path(folder))
            costs = {f"plan of {size}": (cost, {"jobs": jobs})}
            row = f"{trials:>6} {shards:>7} {'no' if batches is JOB_EACH else 'yes':>8} {jobs:>7}"
            print(f"planned  {row} {cost}", flush=True)
            if asked.run:
                files, files_MB, cost = run(Path(folder))
                costs[f"run of {size}"] = cost, {"jobs": jobs, "files": files, "files_MB": files_MB}
                print(f"run      {row} {cost} {files:>7} {files_MB:>12.0f}", flush=True)
        for subject, (cost, counted) in costs.items():
            taken[subject][case] = cost.wall_s
            more[subject][case] = {"processor_s": cost.processor_s, "held_MB": cost.memory_MB, **counted}
    for subject, seconds in taken.items():
        record(subject, seconds, more=more[subject])


if __name__ == "__main__":
    main()
