"""A process killed, or a disk that fills, while a file is written: it is there whole or not at all."""

import multiprocessing
import os
import resource
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from small_results import OTHER, REPOSITORY, STUDY, VARIANT, Results, content

from flexsurr.cli.trajectories import simulate
from flexsurr.storage import write_json
from flexsurr.storage.frames import write_frame
from flexsurr.surrogates import load, save
from flexsurr.training.epochs import CHECKPOINT, write_checkpoint

LARGE = np.random.default_rng(0).normal(size=4096)
FITS = 512  # bytes, and every file here is larger


def weights(results: Results, path: Path) -> None:
    save(load(results.root / "runs" / OTHER / "weights.npz"), path)


WRITERS: dict[str, tuple[str, Callable[[Results, Path], None]]] = {
    "shard": ("shard-0000.parquet", lambda results, path: results.simulate(0, path)),
    "manifest": ("manifest.json", Results.manifest),
    "table": ("cost.parquet", lambda results, path: write_frame(path, pd.DataFrame({"x": LARGE}))),
    "keys": ("metrics.json", lambda results, path: write_json(path, {"x": LARGE.tolist()})),
    "weights": ("weights.npz", weights),
    "checkpoint": (CHECKPOINT, lambda results, path: write_checkpoint(path.parent, {}, state={"x": LARGE})),
}


def is_as_if_undisturbed(path: Path, write: Callable[[Results, Path], None], whole: Results) -> None:
    """A table knows its folder: the other one has a folder of that name."""
    undisturbed = path.parent / "undisturbed" / path.parent.name / path.name
    undisturbed.parent.mkdir(parents=True)
    write(whole, undisturbed)
    assert content(path) == content(undisturbed)


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("before", [None, b"what was there before"])
def test_a_full_disk_leaves_what_was_there(whole, tmp_path, kind, before):
    """No file may grow beyond a few bytes, as on a disk that is full; the next try, with room, is well."""
    name, write = WRITERS[kind]
    path = tmp_path / name
    if before:
        path.write_bytes(before)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (FITS, hard))
    try:
        with pytest.raises(OSError, match="File too large"):
            write(whole, path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert (path.read_bytes() if path.exists() else None) == before
    assert [each.name for each in tmp_path.iterdir() if each.name != name] == []
    write(whole, path)
    assert path.stat().st_size > FITS
    is_as_if_undisturbed(path, write, whole)


SMALL_DISK = """
mount -t tmpfs -o size=4k none "$1" && cd "$1" && shift
"$@"
echo "$? and $(ls -A)"
"""
NAMESPACES = (("unshare", "--mount"), ("unshare", "--map-root-user", "--mount"))
"""Root mounts in one of its own; whoever is not, in one where that user is root, if the kernel has such."""


def where_one_may_mount() -> tuple[str, ...] | None:
    """The first of these in which a small disk can be had; none in a container that may mount nothing."""
    probe = ("mount", "-t", "tmpfs", "-o", "size=4k", "none", "/tmp")
    refused = (subprocess.run([*own, *probe], capture_output=True).returncode for own in NAMESPACES)
    chosen = (own for own, code in zip(NAMESPACES, refused, strict=True) if code == 0)
    return next(chosen, None) if shutil.which("unshare") else None


NAMESPACE = where_one_may_mount()


@pytest.mark.skipif(
    NAMESPACE is None, reason="nobody may mount anything here, neither root nor in a user namespace"
)
def test_a_disk_that_is_too_small_is_one_line_and_keeps_nothing_half_written(whole, tmp_path):
    """A real one, of one page of memory, which the namespace takes along when it ends."""
    job, *_ = (whole.root / "jobs").glob("simulate-*.json")
    simulate = [sys.executable, "-m", "flexsurr", "simulate", "--job", str(job), "--output", "shard.parquet"]
    done = subprocess.run(
        [*NAMESPACE, "sh", "-c", SMALL_DISK, "sh", str(tmp_path), *simulate],
        env=os.environ | {"PYTHONPATH": str(REPOSITORY)},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.stdout == "1 and \n"
    (said,) = [line for line in done.stderr.splitlines() if line.startswith("flexsurr simulate: ")]
    assert "No space left on device" in said
    assert "Traceback" not in done.stderr


def _killed(write: Callable[[Results, Path], None], results: Results, path: Path) -> None:
    """In a process of its own, which is killed when it moves the file to its place."""
    os.replace = lambda beside, place: os.kill(os.getpid(), signal.SIGKILL)
    write(results, path)


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")  # of Python 3.12: nothing here holds a lock
@pytest.mark.parametrize("kind", WRITERS)
def test_a_kill_leaves_nothing_that_looks_whole(whole, tmp_path, kind):
    """Killed at the last moment, with everything written beside; the next try uses that up."""
    name, write = WRITERS[kind]
    path = tmp_path / name
    process = multiprocessing.get_context("fork").Process(target=_killed, args=(write, whole, path))
    process.start()
    process.join(60)
    assert process.exitcode == -signal.SIGKILL
    assert not path.exists()
    write(whole, path)
    assert [each.name for each in tmp_path.iterdir()] == [name]
    is_as_if_undisturbed(path, write, whole)


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")  # likewise
def test_a_simulation_killed_while_it_writes_is_made_again_as_if_undisturbed(whole, tmp_path):
    """Of a shard so large that its writing takes a while: what is half written is used up."""
    job = whole.job("simulate", STUDY, VARIANT, 0) | {"count": 2000}
    path = tmp_path / "shard-0000.parquet"
    process = multiprocessing.get_context("fork").Process(target=simulate, args=(job, path))
    process.start()
    while process.is_alive() and not list(tmp_path.iterdir()):
        pass
    process.kill()
    process.join(60)
    assert process.exitcode == -signal.SIGKILL
    (half,) = tmp_path.iterdir()
    assert half.name == f".{path.name}.part"
    simulate(job, path)
    assert list(tmp_path.iterdir()) == [path]
    is_as_if_undisturbed(path, lambda _, beside: simulate(job, beside), whole)
