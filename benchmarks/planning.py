"""What planning a sweep costs: time, memory and jobs against its number of trials, tiny ones.

    python benchmarks/planning.py             # up to 10,000 trials in batches, up to 1,000 in a job each
    python benchmarks/planning.py 5000 1000   # so many trials and shards, in batches and in a job each

It plans (`snakemake --dry-run`) the cantilever of the quick preset up to its selection and its table of
training, in a copy of the configuration.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

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
    (root / PRESET).write_text(yaml.safe_dump(preset | {"batches": batches, "studies": ["cantilever"]}))
    (root / "config/sweeps/quick.yaml").write_text(yaml.safe_dump(sweep(trials)))


def plan(root: Path) -> tuple[float, float, float, int]:
    """Wall and processor seconds, MB and number of jobs of a dry run in `root`."""
    options = ["--dry-run", "--quiet", "rules", "--configfile", PRESET]
    command = [sys.executable, "-m", "snakemake", *TARGETS, *options]
    environment = os.environ | {"PYTHONPATH": str(PROJECT)}
    began = time.perf_counter()
    process = subprocess.Popen(
        command,
        cwd=root,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert process.stdout is not None
    said = process.stdout.read()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(said[-2000:])
    jobs = re.search(r"^total\s+(\d+)", said, re.MULTILINE)
    assert jobs, said[-2000:]
    processor_s = used.ru_utime + used.ru_stime
    return time.perf_counter() - began, processor_s, used.ru_maxrss / 1024, int(jobs[1])


def main() -> None:
    """Print a row for each number of trials, in batches and in a job each."""
    if len(sys.argv) > 1:
        trials, shards = map(int, sys.argv[1:3])
        cases = [(trials, shards, UNSAID), (trials, shards, JOB_EACH)]
    else:
        cases = [(count, 4, UNSAID) for count in (100, 1_000, 10_000)]
        cases += [(count, 4, JOB_EACH) for count in (100, 1_000)]
    seconds: dict[tuple[int, int], dict[str, float | None]] = {}
    more: dict[tuple[int, int], dict[str, dict[str, float | None]]] = {}
    print("trials  shards  batches    jobs  wall s  processor s      MB")
    for trials, shards, batches in cases:
        with tempfile.TemporaryDirectory() as folder:
            prepare(Path(folder), trials, shards, batches)
            wall_s, processor_s, memory, jobs = plan(Path(folder))
        batched = "no" if batches is JOB_EACH else "yes"
        case, size = "in batches" if batches is UNSAID else "a job each", (trials, shards)
        seconds.setdefault(size, {})[case] = wall_s
        more.setdefault(size, {})[case] = {"processor_s": processor_s, "held_MB": memory, "jobs": jobs}
        costs = f"{wall_s:>7.1f} {processor_s:>12.1f} {memory:>7.0f}"
        print(f"{trials:>6} {shards:>7} {batched:>8} {jobs:>7} {costs}", flush=True)
    for (trials, shards), taken in seconds.items():
        record(f"plan of {trials} trials on {shards} shards", taken, more=more[trials, shards])


if __name__ == "__main__":
    main()
