"""What a figure or a table reads: the files of its study, as its function's arguments, and its caption."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from flexsurr.cli.command import Job
from flexsurr.cli.frames import read_frame
from flexsurr.cli.runs import read_run
from flexsurr.config.structure import Structure


def arguments(job: Job, results: Path, known: Mapping[str, Any] | None = None) -> list[Any]:
    """What the job `reads`, in its order: its structure, what is `known`, or what its files hold."""
    known = known or {}
    return [
        known[read] if read in known else _read(read, job, [results / file for file in files])
        for read, files in job["reads"].items()
    ]


def text_of(caption: Path) -> str:
    """What to see in a table, on one line."""
    return " ".join(caption.read_text(encoding="utf-8").split())


def _read(read: str, job: Job, files: Sequence[Path]) -> Any:
    if read == "structure":
        return Structure.model_validate(job["structure"])
    if read == "sweeps":
        return job["sweeps"]
    if read in ("metrics", "relatives"):
        return pd.DataFrame([read_run(path) for path in files])
    if read == "history":
        frames = [read_frame(path).assign(run_id=path.parent.name) for path in files]
    else:
        frames = [read_frame(path) for path in files]
    return pd.concat([frame for frame in frames if len(frame)] or frames, ignore_index=True)
