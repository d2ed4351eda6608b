"""Wall time of one simulation, on one thread."""

import gc
import statistics
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import TypeVar

Result = TypeVar("Result")


def wall_time(run: Callable[[], Result], repeats: int = 1) -> tuple[Result, float]:
    """The result of `run` and its median wall time [s] over `repeats` calls, garbage collection off.

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
    finally:
        if collecting:
            gc.enable()
    return result, statistics.median(times)


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold torch to one thread, if it is loaded. The matrices in NumPy are too small for a second one."""
    torch = sys.modules.get("torch")
    if torch is None:
        yield
        return
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)
