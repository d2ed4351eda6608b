"""How everything here is timed: warmed up, repeated in turns, reported as a median with its spread.

Where the environment names a file in `ROWS`, each timing is added to it as a row (`benchmarks/run.py`).
"""

import json
import os
import statistics
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields
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
    """What every line of results/tables/benchmarks.csv begins with: `peer` was timed in turns with `ours`.

    `ours_s` and `peer_s` are medians, `ratio` is the median of those within a turn. Errors stand where the
    benchmark knows them, and are relative to a peak. What was run once has no spread; what was not timed, or
    did not get there, no seconds.
    """

    subject: str  # the benchmark
    work: str
    ours: str
    ours_s: float | None
    peer: str
    peer_s: float | None
    ratio: float | None
    ratio_spread: float | None
    error_ours: float | None
    error_peer: float | None
    peer_spread_s: float | None
    peer_lowest_s: float | None
    repeats: int


COLUMNS = [field.name for field in fields(Row)]
More = Mapping[str, Mapping[str, float | str | None]]
"""Of each case what only its benchmark knows, by the name of its column."""


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
    more: More | None = None,
) -> dict[str, Timing]:
    """Time several calls in turns, each against the first.

    A call that does its work `counts` times over is reported by one of them. `errors` of the calls, as parts
    of a peak, and what `more` is known are kept beside their times. ValueError with fewer than two repeats,
    which have no spread.
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
    errors, ours = errors or {}, timings[first]
    for peer, timing in timings.items():
        row = Row(
            subject=_subject(),
            work=what,
            ours=first,
            ours_s=ours.median_s,
            peer=peer,
            peer_s=timing.median_s,
            ratio=timing.ratio,
            ratio_spread=timing.ratio_spread,
            error_ours=errors.get(first),
            error_peer=errors.get(peer),
            peer_spread_s=timing.spread_s,
            peer_lowest_s=timing.lowest_s,
            repeats=timing.repeats,
        )
        _add(row, (more or {}).get(peer, {}))
    return timings


def record(
    what: str,
    seconds: Mapping[str, float | None],
    errors: Mapping[str, float] | None = None,
    more: More | None = None,
) -> None:
    """Keep what was run once, each case beside the first; None for what was not timed, or never got there."""
    errors, first = errors or {}, next(iter(seconds))
    ours = seconds[first]
    for peer, taken in seconds.items():
        row = Row(
            subject=_subject(),
            work=what,
            ours=first,
            ours_s=ours,
            peer=peer,
            peer_s=taken,
            ratio=taken / ours if taken and ours else None,
            ratio_spread=None,
            error_ours=errors.get(first),
            error_peer=errors.get(peer),
            peer_spread_s=None,
            peer_lowest_s=taken,
            repeats=1,
        )
        _add(row, (more or {}).get(peer, {}))


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


def _subject() -> str:
    return Path(sys.argv[0]).stem


def _add(row: Row, more: Mapping[str, float | str | None]) -> None:
    path = os.environ.get(ROWS)
    if path:
        with open(path, "a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(row) | dict(more)) + "\n")
