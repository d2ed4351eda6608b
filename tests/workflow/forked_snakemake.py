"""Snakemake forked from a process that has imported it: to import it takes longer than many a run."""

import atexit
import multiprocessing
import os
import signal
import sys
from collections.abc import Sequence
from pathlib import Path

_FORKS = multiprocessing.get_context("forkserver")
_FORKS.set_forkserver_preload(["snakemake.cli", "pydantic"])


def run(arguments: Sequence[str], root: Path, code: Path, said: Path, within_s: float = 1800.0) -> int:
    """The exit code of `python -m snakemake` in the folder `root` with flexsurr from the folder `code`.

    In a session of its own, as a terminal would run it; its output goes to the file `said`.
    """
    environment = os.environ | {"PYTHONPATH": str(code)}
    process = _FORKS.Process(target=_run, args=(arguments, root, code, said, environment), daemon=True)
    process.start()
    try:
        process.join(within_s)
        assert process.exitcode is not None, f"it takes longer than {within_s} s"
        return process.exitcode
    finally:
        if process.exitcode is None:
            os.killpg(process.pid, signal.SIGKILL)


def _run(arguments: Sequence[str], root: Path, code: Path, said: Path, environment: dict[str, str]) -> None:
    os.setsid()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.chdir(root)
    with said.open("wb") as output:
        for stream in (sys.stdout, sys.stderr):
            os.dup2(output.fileno(), stream.fileno())
    os.environ.clear()
    os.environ.update(environment)
    installed = [path for path in sys.path if path.startswith((sys.prefix, sys.base_prefix))]
    sys.path[:] = [str(root), str(code), *installed]
    sys.argv[:] = ["snakemake", *arguments]
    from snakemake.cli import main

    try:
        main(arguments)
    finally:
        atexit._run_exitfuncs()  # a fork would leave them out
