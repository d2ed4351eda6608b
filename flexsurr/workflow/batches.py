"""Many trials or shards in one job: to plan, submit and start a job costs more than a tiny trial does.

A batch leaves a note of the files that it has made, and Snakemake looks at that alone.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

from flexsurr.storage import StorageError, read_json

MANY = 200
"""So many have a job each, unless the configuration says otherwise."""

JOBS = 128
"""What more than so many make, one or two dozen each in a sweep of thousands."""


def number_of_batches(total: int, per_job: int | None) -> int:
    """How many batches `total` trials or shards make, `per_job` in each; 0 where each has a job of its own.

    A power of two: while a sweep grows, batches stay what they were until it has doubled. Never more than
    `JOBS`, however few are asked for in each.
    """
    if per_job is None:
        return JOBS if total > MANY else 0
    return 0 if per_job == 1 else min(JOBS, 1 << (-(-total // per_job) - 1).bit_length())


def batches_of_runs(keys: Sequence[str], per_job: int | None) -> dict[str, list[str]]:
    """run_ids by the name of their batch.

    A run's batch follows from its own name: a value that a sweep gains or loses leaves the others in theirs.
    """
    count = number_of_batches(len(keys), per_job)
    batches: dict[str, list[str]] = {}
    for key in keys if count else ():
        batches.setdefault(_name(int(key.rpartition("-")[2], 16) % count, count), []).append(key)
    return batches


def batch_of_shard(shard: int, total: int, per_job: int | None) -> str | None:
    """The name of the batch of one of `total` shards; None where each has a job of its own."""
    count = number_of_batches(total, per_job)
    return _name(shard % count, count) if count else None


def shards_of_batch(batch: str, total: int) -> range:
    """The shards that have `batch` for theirs."""
    number, _, count = batch.partition("-of-")
    return range(int(number), total, int(count))


def outdated(results: Path) -> Iterator[Path]:
    """Notes of batches below `results` that are damaged, or tell of a file that has been deleted since."""
    for pattern in ("batches/*/trials-*.json", "datasets/*/*/shards-*.json"):
        for note in sorted(results.glob(pattern)):
            try:
                made = read_json(note, ["made"])["made"]
            except StorageError:
                yield note
                continue
            if not all((results / file).is_file() for file in made):
                yield note


def _name(number: int, count: int) -> str:
    return f"{number}-of-{count}"
