"""Every kind of file, damaged in every way: the command that reads it names it, and it can be made again."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from small_results import OTHER, REPOSITORY, RUN, STUDY, VARIANT, Results, content

from flexsurr.cli.report import join
from flexsurr.cli.runs import selected_surrogates
from flexsurr.storage import DamagedFile
from flexsurr.storage.frames import read_frame
from flexsurr.surrogates import load
from flexsurr.training.epochs import write_checkpoint
from flexsurr.workflow.job_files import write_job


class Kind(NamedTuple):
    """A kind of file: one of them, who reads it, who makes it again, and a file that is another's."""

    file: str
    read: Callable[[Results], object]
    make: Callable[[Results], object]
    foreign: str


def selected(results: Results) -> None:
    selected_surrogates(results.root / "selected" / f"{STUDY}.json", VARIANT, results.root / "runs")


def joined(results: Results) -> None:
    join({}, [results.root / "tables" / STUDY / "static_tip.csv"], results.root / "tables")


def history(results: Results) -> None:
    read_frame(results.run / "history.parquet")


DATASET = f"datasets/{STUDY}/{VARIANT}"
KINDS = {
    "shard": Kind(
        f"{DATASET}/shard-0001.parquet",
        Results.manifest,
        lambda results: results.simulate(1),
        f"evaluation/{STUDY}/statics.parquet",
    ),
    "shard of a manifest": Kind(
        f"{DATASET}/shard-0001.parquet",
        Results.train,
        lambda results: results.simulate(1),
        f"{DATASET}/shard-0000.parquet",
    ),
    "manifest": Kind(f"{DATASET}/manifest.json", Results.train, Results.manifest, f"runs/{RUN}/fit.json"),
    "fit": Kind(f"runs/{RUN}/fit.json", Results.score, Results.train, f"runs/{OTHER}/fit.json"),
    "weights": Kind(f"runs/{RUN}/weights.npz", Results.score, Results.train, f"runs/{RUN}/fit.json"),
    "weights of the choice": Kind(f"runs/{RUN}/weights.npz", selected, Results.train, f"runs/{RUN}/fit.json"),
    "metrics": Kind(f"runs/{RUN}/metrics.json", Results.select, Results.score, f"runs/{OTHER}/metrics.json"),
    "history": Kind(f"runs/{RUN}/history.parquet", history, Results.train, f"runs/{OTHER}/history.parquet"),
    "selection": Kind(f"selected/{STUDY}.json", selected, Results.select, f"runs/{RUN}/metrics.json"),
    "evaluation": Kind(
        f"evaluation/{STUDY}/statics.parquet",
        lambda results: results.tabulate("static_tip"),
        Results.statics,
        f"evaluation/{STUDY}/frequencies.parquet",
    ),
    "table": Kind(
        f"tables/{STUDY}/static_tip.csv",
        joined,
        lambda results: results.tabulate("static_tip"),
        f"runs/{RUN}/weights.npz",
    ),
}


def halve(path: Path, foreign: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def empty(path: Path, foreign: Path) -> None:
    path.write_bytes(b"")


def replace(path: Path, foreign: Path) -> None:
    path.write_bytes(foreign.read_bytes())


def flip(path: Path, foreign: Path) -> None:
    """One bit: of a Parquet file's directory, of an array, or of the first opening brace."""
    content = bytearray(path.read_bytes())
    content[{".parquet": -6, ".npz": 60}.get(path.suffix, 0)] ^= 1
    path.write_bytes(content)


CASES = [(name, damage) for name in KINDS for damage in (halve, empty, replace, flip)]
CASES.remove(("table", flip))  # text without a checksum


@pytest.mark.parametrize(("name", "damage"), CASES)
def test_a_damaged_file_is_named_and_made_again_as_it_was(results, whole, name, damage):
    kind = KINDS[name]
    path = results.root / kind.file
    damage(path, results.root / kind.foreign)
    with pytest.raises(DamagedFile) as caught:
        kind.read(results)
    assert str(caught.value).startswith(f"{path}: ")
    assert len(str(caught.value).splitlines()) == 1
    path.unlink()
    kind.make(results)
    kind.read(results)
    assert content(path) == content(whole.root / kind.file)


def test_the_command_says_what_to_do(results):
    path = results.run / "metrics.json"
    halve(path, path)
    job = write_job(
        results.root / "jobs", "select", {"study": STUDY, "sweeps": {"default": [RUN]}, "selection": {}}
    )
    words = [sys.executable, "-m", "flexsurr", "select", "--job", str(job), "--runs"]
    words += [str(results.root / "runs"), "--output", str(results.root / "choice.json")]
    done = subprocess.run(words, cwd=REPOSITORY, capture_output=True, text=True, timeout=120)
    assert done.returncode == 1
    (said,) = [line for line in done.stderr.splitlines() if line.startswith("flexsurr select: ")]
    assert said.endswith(f"{path}: damaged or truncated, not JSON; delete it, and snakemake makes it again")
    assert "Traceback" not in done.stderr


def test_a_damaged_job_is_written_anew(tmp_path):
    job = {"study": STUDY, "list": [1, 2]}
    path = write_job(tmp_path, "select", job)
    halve(path, path)
    assert write_job(tmp_path, "select", job) == path
    assert json.loads(path.read_text()) == job


@pytest.mark.parametrize("damage", ["halved", "empty", "another's"])
def test_a_checkpoint_that_is_of_no_use_is_passed_over(results, whole, damage):
    """The training begins anew, and ends as one that was never disturbed."""
    folder = results.root / "runs" / OTHER
    write_checkpoint(folder, {"trial": damage}, optimiser={"x": np.arange(3.0)})
    checkpoint = folder / "checkpoint.npz"
    if damage != "another's":
        checkpoint.write_bytes(checkpoint.read_bytes()[: {"halved": 200, "empty": 0}[damage]])
    results.train(OTHER)
    assert not checkpoint.exists()
    ours, theirs = (load(each.root / "runs" / OTHER / "weights.npz") for each in (results, whole))
    np.testing.assert_array_equal(ours.parameters, theirs.parameters)
