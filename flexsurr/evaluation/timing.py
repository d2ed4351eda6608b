"""Wall time of one simulation, on one thread."""

import gc
import math
import os
import statistics
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from time import perf_counter
from typing import TypeVar

from flexsurr.simulation.machine_code import unless_compiled_elsewhere

Result = TypeVar("Result")


def wall_time(
    run: Callable[[], Result], repeats: int = 1, enough_s: float = math.inf
) -> tuple[Result, float]:
    """The result of `run` and its median wall time [s] over `repeats` calls, garbage collection off.

    There are no more calls once they have taken `enough_s` [s] together: what takes long is steady.
    The caller warms up: the first call of a compiled function compiles it or loads it from the disk.
    """
    if repeats < 1:
        raise ValueError(f"repeats: at least 1, not {repeats}")
    times = []
    collecting = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        for _ in range(repeats):
            start = perf_counter()
            result = run()
            times.append(perf_counter() - start)
            if sum(times) >= enough_s:
                break
    finally:
        if collecting:
            gc.enable()
    return result, statistics.median(times)


def cores() -> int:
    """How many cores this process may use, where the system says so."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1


def compile_ahead(firsts: Iterable[Callable[[], object]]) -> None:
    """Call each of `firsts` in one of as many child processes as there are cores, and wait for them.

    Each is the first call of something compiled, whose machine code the child leaves on the disk, where
    this process finds it at its own first call. An error is left for that call too, and so is what another
    job compiles meanwhile. Children are forks, which end with this process: call it before anything has
    started threads.
    """
    waiting = list(firsts)
    number = min(cores(), len(waiting))
    if number < 2:
        return
    children = [
        get_context("fork").Process(target=_call_all, args=(waiting[first::number],), daemon=True)
        for first in range(number)
    ]
    for child in children:
        child.start()
    for child in children:
        child.join()


def _call_all(calls: Iterable[Callable[[], object]]) -> None:
    for call in calls:
        with suppress(Exception), unless_compiled_elsewhere():
            call()


@contextmanager
def measuring() -> Iterator[None]:
    """For a series of `wall_time`: one thread for torch, and nothing old for the collector to look through.

    The matrices in NumPy are too small for a second thread. With torch and numba loaded, each collection
    would take longer than what is timed; what exists now is exempt from those of the block.
    """
    torch = sys.modules.get("torch")
    threads = torch.get_num_threads() if torch else 1
    gc.collect()
    gc.freeze()
    try:
        if torch:
            torch.set_num_threads(1)
        yield
    finally:
        gc.unfreeze()
        if torch:
            torch.set_num_threads(threads)
