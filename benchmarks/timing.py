"""How everything here is timed: warmed up, repeated in turns, reported as a median with its spread.

Where the environment names a file in `ROWS`, each timing is added to it as a row (`benchmarks/run.py`).
"""

import csv
import os
import statistics
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import astuple, dataclass, fields
from pathlib import Path

ROWS = "FLEXSURR_BENCHMARK_ROWS"


@dataclass(frozen=True)
class Timing:
    """Wall seconds of one call, over repeats, and the ratio to what was timed in turns with it."""

    median_s: float
    lowest_s: float
    spread_s: float
    """Half the distance between the quartiles: other work on the machine hardly moves it."""
    repeats: int
    ratio: float
    """Median of the ratios to the first call of the same turn: a slow spell of the machine meets both."""
    ratio_spread: float

    def __str__(self) -> str:
        scale, unit = next(
            (s, u) for s, u in ((1, "s"), (1e3, "ms"), (1e6, "µs")) if self.median_s * s >= 1 or u == "µs"
        )
        return f"{self.median_s * scale:.3g} ± {self.spread_s * scale:.1g} {unit}"


@dataclass(frozen=True)
class Row:
    """One line of results/tables/benchmarks.csv, but for the machine: `peer` was timed in turns with `ours`.

    `ours_s` and `peer_s` are medians, `ratio` is the median of those within a turn. Errors stand where the
    benchmark knows them, and are relative to a peak.
    """

    subject: str  # the benchmark
    work: str
    ours: str
    ours_s: float
    peer: str
    peer_s: float
    ratio: float
    ratio_spread: float
    error_ours: float | None
    error_peer: float | None
    peer_spread_s: float
    peer_lowest_s: float
    repeats: int


COLUMNS = [field.name for field in fields(Row)]


def measure(
    what: str, case: str, call: Callable[[], object], repeats: int = 20, warmup: int = 2, calls: int = 1
) -> Timing:
    """Time `call` alone, after `warmup` calls that are not counted (the first may compile)."""
    return compare(what, {case: call}, repeats, warmup, {case: calls})[case]


def compare(
    what: str,
    calls: dict[str, Callable[[], object]],
    repeats: int = 20,
    warmup: int = 2,
    counts: dict[str, int] | int = 1,
    errors: Mapping[str, float] | None = None,
) -> dict[str, Timing]:
    """Time several calls in turns, each against the first.

    A call that does its work `counts` times over is reported by one of them. `errors` of the calls, as parts
    of a peak, are kept beside their times. ValueError with fewer than two repeats, which have no spread.
    """
    if repeats < 2:
        raise ValueError("a spread needs at least two repeats")
    for call in calls.values():
        for _ in range(warmup):
            call()
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(repeats):
        for name, call in calls.items():
            count = counts if isinstance(counts, int) else counts.get(name, 1)
            seconds[name].append(_seconds(call) / count)
    first = next(iter(calls))
    timings = {name: _timing(values, seconds[first]) for name, values in seconds.items()}
    _note(what, first, timings, errors or {})
    return timings


def _seconds(call: Callable[[], object]) -> float:
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def _timing(seconds: list[float], first: list[float]) -> Timing:
    low, median, high = statistics.quantiles(seconds, n=4)
    low_ratio, ratio, high_ratio = statistics.quantiles(
        [own / other for own, other in zip(seconds, first, strict=True)], n=4
    )
    return Timing(
        median_s=median,
        lowest_s=min(seconds),
        spread_s=0.5 * (high - low),
        repeats=len(seconds),
        ratio=ratio,
        ratio_spread=0.5 * (high_ratio - low_ratio),
    )


def _note(work: str, ours: str, timings: dict[str, Timing], errors: Mapping[str, float]) -> None:
    path = os.environ.get(ROWS)
    if not path:
        return
    rows = [
        Row(
            subject=Path(sys.argv[0]).stem,
            work=work,
            ours=ours,
            ours_s=timings[ours].median_s,
            peer=peer,
            peer_s=timing.median_s,
            ratio=timing.ratio,
            ratio_spread=timing.ratio_spread,
            error_ours=errors.get(ours),
            error_peer=errors.get(peer),
            peer_spread_s=timing.spread_s,
            peer_lowest_s=timing.lowest_s,
            repeats=timing.repeats,
        )
        for peer, timing in timings.items()
    ]
    with open(path, "a", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows(map(astuple, rows))
