"""Many small jobs in one process: each is made once, and noted as soon as it is there.

Beside what an item leaves stands a note of what it was made from: its values, the content of what it reads,
and the code. A batch that is started again makes those that have no such note, or another.
"""

import hashlib
import json
import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

from flexsurr.cli.command import Job
from flexsurr.storage import StorageError, read_json, write_json
from flexsurr.storage.atomic import read_bytes
from flexsurr.workflow.code_digest import code_digest

log = logging.getLogger(__name__)

OF_A_RUN = ("parameters.json", "fit.json", "history.parquet", "weights.npz", "best.npz", "metrics.json")


@dataclass(frozen=True)
class Item:
    """One of them: its name, its values, and how it is made. Files are named below the results."""

    name: str
    job: Mapping[str, Any]
    reads: Sequence[str]
    leaves: Sequence[str]
    note: str
    make: Callable[[], None]


def make_all(
    items: Sequence[Item], code: str, results: Path, output: Path, refused: tuple[type[Exception], ...] = ()
) -> None:
    """Make every item that is not there as the code of the command `code` makes it; their names to `output`.

    What one of them raises of the types `refused` ends that one alone; StorageError names them at the end.
    """
    expected: tuple[type[Exception], ...] = (StorageError, *refused)
    digest = code_digest(f"flexsurr.cli.{code}")
    contents = cache(lambda file: hashlib.sha256(read_bytes(results / file)).hexdigest())
    problems = []
    for number, item in enumerate(items, start=1):
        made_from = {"code": digest, "job": item.job, "reads": {file: contents(file) for file in item.reads}}
        note = hashlib.sha256(json.dumps(made_from, sort_keys=True).encode()).hexdigest()
        if all((results / file).is_file() for file in item.leaves) and _noted(results / item.note) == note:
            continue
        log.info("%s, %d of %d", item.name, number, len(items))
        (results / item.note).unlink(missing_ok=True)
        try:
            item.make()
        except expected as error:
            log.error("%s: %s", item.name, error)
            problems.append(f"{item.name}: {error}")
            continue
        write_json(results / item.note, {"made_from": note})
    if problems:
        raise StorageError("\n".join(problems))
    write_json(output, {"made": [item.name for item in items]})


def _noted(path: Path) -> str | None:
    """What a note says; None where there is none, or a damaged one."""
    try:
        made_from: str = read_json(path, ["made_from"])["made_from"]
    except StorageError:
        return None
    return made_from


def trials_of(
    job: Job, results: Path, make: Callable[[Job, Path, list[Path], list[Path]], None]
) -> list[Item]:
    """The trials of a batch, each made by `make(job, folder, trains on, scored on)`."""

    def item(key: str, trial: Job) -> Item:
        folder = f"runs/{key}"
        read = [[results / file for file in trial[which]] for which in ("trains_on", "scored_on")]
        return Item(
            key,
            trial,
            [*trial["trains_on"], *trial["scored_on"]],
            [f"{folder}/{name}" for name in OF_A_RUN],
            f"{folder}/made.json",
            partial(make, trial, results / folder, *read),
        )

    return [item(key, trial) for key, trial in job["trials"].items()]


def shards_of(job: Job, results: Path, make: Callable[[Job, Path], None]) -> list[Item]:
    """The shards of a batch, each made by `make(job, file)`."""
    return [
        Item(file, shard, (), [file], f"{file}.json", partial(make, shard, results / file))
        for file, shard in job["shards"].items()
    ]
