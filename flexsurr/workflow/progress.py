"""How far a run of the workflow is: what runs, how much is left, and when it will end.

Snakemake tells of jobs that start and end (`progress.smk`). How long the others will take is an estimate: the
mean of the jobs of the same rule in this run; before there is one, that of an earlier run, from its benchmark
files; else the time that such a job took in the default study.
"""

import logging
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean

# Wall time [s] on the machine of docs/measurements.md.
TYPICAL_S = {
    "simulate": 4.0,
    "sample": 4.0,
    "shards": 8.0,
    "train": 15.0,
    "score": 5.0,
    "trials": 40.0,
    "responses": 12.0,
    "validation": 15.0,
    "learn_load": 5.0,
    "rehearse": 40.0,
    "evaluate": 90.0,
    "fly": 20.0,
    "fly_references": 240.0,
    "fly_randomly": 90.0,
    "draw": 4.0,
}
OTHERWISE_S = 2.0

SHOWN = 3
"""So many of the jobs that run are named."""


def earlier_means(benchmarks: Path) -> dict[str, float]:
    """Mean wall time [s] of the jobs of each rule, by its folder in `benchmarks`, of what is there.

    A file that is no benchmark of Snakemake's counts for nothing.
    """
    means = {}
    for folder in benchmarks.glob("*"):
        if times := [seconds for path in folder.glob("*.tsv") for seconds in _seconds(path)]:
            means[folder.name] = fmean(times)
    return means


def _seconds(path: Path) -> Iterator[float]:
    """The first column of a benchmark file, below its heading."""
    try:
        _, *rows = path.read_text(encoding="utf-8").splitlines()
        yield from [float(row.split("\t")[0]) for row in rows]
    except (OSError, ValueError):
        return


@dataclass
class _Running:
    rule: str
    what: str
    since_s: float


@dataclass
class Progress:
    """What is known of a run on `cores` cores (None: elsewhere). `alone` are the rules whose jobs take all.

    `earlier` are mean times [s] of an earlier run, `now` tells the time [s].
    """

    cores: int | None
    alone: Collection[str] = ()
    earlier: Mapping[str, float] = field(default_factory=dict)
    now: Callable[[], float] = time.time

    def __post_init__(self) -> None:
        self._left: Counter[str] = Counter()
        self._took: dict[str, list[float]] = defaultdict(list)
        self._running: dict[int, _Running] = {}
        self._total = 0
        self._began_s = self.now()

    def planned(self, jobs: Mapping[str, int]) -> None:
        """`jobs` of each rule are to be done."""
        self._left, self._total = Counter(jobs), sum(jobs.values())
        self._began_s = self.now()

    def started(self, number: int, rule: str, what: str) -> None:
        """The job of this number began; `what` it does, in words."""
        self._running[number] = _Running(rule, what, self.now())

    def ended(self, number: int, well: bool = True) -> None:
        """The job of this number is done, or has failed."""
        if (job := self._running.pop(number, None)) is not None:
            self._left[job.rule] -= 1
            if well:
                self._took[job.rule].append(self.now() - job.since_s)

    @property
    def left_s(self) -> float | None:
        """About how many seconds are left; None where nobody says how many cores there are."""
        if self.cores is None:
            return None
        shared = alone = 0.0
        for rule, count in self._left.items():
            seconds = max(count, 0) * self._of(rule)
            if rule in self.alone:
                alone += seconds
            else:
                shared += seconds
        for job in self._running.values():
            done = min(self.now() - job.since_s, self._of(job.rule))
            if job.rule in self.alone:
                alone -= done
            else:
                shared -= done
        return alone + shared / self.cores

    def _of(self, rule: str) -> float:
        """Seconds of one job."""
        if took := self._took.get(rule):
            return fmean(took)
        family = rule.partition("_")[0]  # draw_wing_runs is one of the jobs that draw
        for times in (self.earlier, TYPICAL_S):
            for name in (rule, family):
                if name in times:
                    return times[name]
        return OTHERWISE_S

    def line(self) -> str:
        """Everything of it, on one line."""
        now = self.now()
        left = sum(max(count, 0) for count in self._left.values())
        parts = [f"{self._total - left} of {self._total} jobs done in {_span(now - self._began_s)}"]
        if left and (left_s := self.left_s) is not None:
            at = time.strftime("%H:%M", time.localtime(now + left_s))
            parts.append(f"about {_span(left_s)} left, until {at}")
        if running := [job.what for job in self._running.values()]:
            more = f" and {len(running) - SHOWN} more" if len(running) > SHOWN else ""
            parts.append("; ".join(running[:SHOWN]) + more)
        return " | ".join(parts)


class Teller(logging.Handler):
    """Follows the jobs by what Snakemake logs of them, and says how far they are after each.

    `progress` is asked for once jobs are planned.
    """

    def __init__(self, progress: Callable[[], Progress], say: Callable[[str], object]) -> None:
        super().__init__()
        self._of_run, self._say = progress, say
        self._progress = Progress(None)

    def emit(self, record: logging.LogRecord) -> None:
        """Take what a record tells by its `event`, a word of Snakemake's."""
        told = vars(record)
        match told.get("event"):
            case "run_info":
                self._progress = self._of_run()
                self._progress.planned(
                    {rule: count for rule, count in told["stats"].items() if rule != "total"}
                )
            case "job_info":
                what = told["rule_msg"] or told["rule_name"]
                self._progress.started(told["jobid"], told["rule_name"], what)
            case "job_error":
                self._progress.ended(told["jobid"], well=False)
            case "job_finished":
                self._progress.ended(told["job_id"])
            case "progress":
                self._say(self._progress.line())


def _span(seconds: float) -> str:
    """A span of time as one says it."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"
