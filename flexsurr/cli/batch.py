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
from flexsurr.storage import StorageError, read_bytes, read_json, write_json
from flexsurr.workflow.code_digest import code_digest

log = logging.getLogger(__name__)

TRAINED = ("parameters.json", "fit.json", "history.parquet", "weights.npz", "best.npz")
SCORED_FROM = ("fit.json", "weights.npz", "best.npz")


@dataclass(frozen=True)
class Item:
    """One of them: its name, the function that makes one alone, its values, and how it is made.

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
    code = cache(code_digest)
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
    job: Job, results: Path, store: Path, train: Callable[..., None], score: Callable[..., None]
) -> list[Item]:
    """The trials of a batch, made by the commands that `train` and `score` one alone.

    What is scored otherwise is not trained again.
    """
    items = []
    for key, trial in job["trials"].items():
        name = f"runs/{key}"
        folder = results / name
        trains_on, scored_on = (
            [results / file for file in trial[which]] for which in ("trains_on", "scored_on")
        )
        data = sorted({file.parent for file in trains_on})
        files = (*(folder / file for file in SCORED_FROM), scored_on, folder / "metrics.json")
        items += [
            Item(
                key,
                _part(train),
                trial["train"],
                trial["trains_on"],
                [f"{name}/{file}" for file in TRAINED],
                f"{name}/trained.json",
                partial(train, trial["train"], data, store, folder),
            ),
            Item(
                f"{key}, its score",
                _part(score),
                trial["score"],
                [*(f"{name}/{file}" for file in SCORED_FROM), *trial["scored_on"]],
                [f"{name}/metrics.json"],
                f"{name}/scored.json",
                partial(score, trial["score"], *files),
            ),
        ]
    return items


def shards_of(job: Job, results: Path, make: Callable[[Job, Path], None]) -> list[Item]:
    """The shards of a batch, each made as the command `make` makes one alone."""
    return [
        Item(file, _part(make), shard, (), [file], f"{file}.json", partial(make, shard, results / file))
        for file, shard in job["shards"].items()
    ]


def _part(command: Callable[..., None]) -> str:
    """The name of a command's function, as `code_digest` takes it."""
    return f"{command.__module__}:{command.__name__}"
