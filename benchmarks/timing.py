"""How everything here is timed: warmed up, repeated, reported as a median with its spread."""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Timing:
    """Wall seconds of one call, over repeats."""

    median_s: float
    lowest_s: float
    spread_s: float
    """Half the distance between the quartiles: other work on the machine hardly moves it."""
    repeats: int

    def __str__(self) -> str:
        scale, unit = next(
            (s, u) for s, u in ((1, "s"), (1e3, "ms"), (1e6, "µs")) if self.median_s * s >= 1 or u == "µs"
        )
        return f"{self.median_s * scale:.3g} ± {self.spread_s * scale:.1g} {unit}"


def measure(call: Callable[[], object], repeats: int = 20, warmup: int = 2) -> Timing:
    """Time `call`, after `warmup` calls that are not counted (the first may compile)."""
    for _ in range(warmup):
        call()
    return _timing([_seconds(call) for _ in range(repeats)])


def compare(calls: dict[str, Callable[[], object]], repeats: int = 20, warmup: int = 2) -> dict[str, Timing]:
    """Time several calls in turns, so that a slow spell of the machine meets all of them alike."""
    for call in calls.values():
        for _ in range(warmup):
            call()
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(repeats):
        for name, call in calls.items():
            seconds[name].append(_seconds(call))
    return {name: _timing(values) for name, values in seconds.items()}


def _seconds(call: Callable[[], object]) -> float:
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def _timing(seconds: list[float]) -> Timing:
    if len(seconds) < 2:
        raise ValueError("a spread needs at least two repeats")
    quartiles = statistics.quantiles(seconds, n=4)
    return Timing(
        median_s=quartiles[1],
        lowest_s=min(seconds),
        spread_s=0.5 * (quartiles[2] - quartiles[0]),
        repeats=len(seconds),
    )
