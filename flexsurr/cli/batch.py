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

TRAINED = ("parameters.json", "fit.json", "history.parquet", "weights.npz", "best.npz")
JUDGED = ("fit.json", "weights.npz", "best.npz")


@dataclass(frozen=True)
class Item:
    """One of them: its name, the command that makes one alone, its values, and how it is made.

    Files are named below the results.
    """

    name: str
    command: str
    job: Mapping[str, Any]
    reads: Sequence[str]
    leaves: Sequence[str]
    note: str
    make: Callable[[], None]


def make_all(
    items: Sequence[Item], results: Path, output: Path, refused: tuple[type[Exception], ...] = ()
) -> None:
    """Make every item that is not there as its command makes it now; what they leave to `output`.

    What one of them raises of the types `refused` ends that one alone, and what reads its files;
    StorageError names them at the end.
    """
    expected: tuple[type[Exception], ...] = (StorageError, *refused)
    code = cache(lambda command: code_digest(f"flexsurr.cli.{command}"))
    contents = cache(lambda file: hashlib.sha256(read_bytes(results / file)).hexdigest())
    problems = []
    for number, item in enumerate(items, start=1):
        if lacking := [file for file in item.reads if not (results / file).is_file()]:
            problems.append(f"{item.name}: {lacking[0]} is missing")
            continue
        made_from = {
            "code": code(item.command),
            "job": item.job,
            "reads": {file: contents(file) for file in item.reads},
        }
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
    write_json(output, {"made": [file for item in items for file in item.leaves]})


def _noted(path: Path) -> str | None:
    """What a note says; None where there is none, or a damaged one."""
    try:
        made_from: str = read_json(path, ["made_from"])["made_from"]
    except StorageError:
        return None
    return made_from


def trials_of(
    job: Job,
    results: Path,
    train: Callable[[Job, list[Path], Path], None],
    score: Callable[[Job, Path, list[Path]], None],
    commands: tuple[str, str],
) -> list[Item]:
    """The trials of a batch: `train(job, trains on, folder)` and `score(job, folder, scored on)` of each.

    `commands` are those that train and score one alone: what is judged otherwise is not trained again.
    """
    items = []
    for key, trial in job["trials"].items():
        folder = f"runs/{key}"
        trains_on, scored_on = (
            [results / file for file in trial[which]] for which in ("trains_on", "scored_on")
        )
        items += [
            Item(
                key,
                commands[0],
                trial["train"],
                trial["trains_on"],
                [f"{folder}/{name}" for name in TRAINED],
                f"{folder}/trained.json",
                partial(train, trial["train"], trains_on, results / folder),
            ),
            Item(
                f"{key}, its score",
                commands[1],
                trial["score"],
                [*(f"{folder}/{name}" for name in JUDGED), *trial["scored_on"]],
                [f"{folder}/metrics.json"],
                f"{folder}/scored.json",
                partial(score, trial["score"], results / folder, scored_on),
            ),
        ]
    return items


def shards_of(job: Job, results: Path, make: Callable[[Job, Path], None], command: str) -> list[Item]:
    """The shards of a batch, each made by `make(job, file)` as `command` makes one alone."""
    return [
        Item(file, command, shard, (), [file], f"{file}.json", partial(make, shard, results / file))
        for file, shard in job["shards"].items()
    ]
