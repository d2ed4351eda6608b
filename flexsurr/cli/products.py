"""What a figure or a table reads: the files of its study, as its function's arguments, and its caption."""

import json
from collections.abc import Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import pandas as pd

from flexsurr.cli.command import Job
from flexsurr.cli.frames import read_frame
from flexsurr.config.structure import Structure


def arguments(reads: Sequence[str], job: Job, inputs: Sequence[Path]) -> list[Any]:
    """What a product of flexsurr.report `reads`, found in the job and among the files `inputs`.

    Raises FileNotFoundError if no file fits one of `reads`.
    """
    return [_read(read, job, inputs) for read in reads]


def text_of(caption: Path) -> str:
    """What to see in a table, on one line."""
    return " ".join(caption.read_text(encoding="utf-8").split())


def _read(read: str, job: Job, inputs: Sequence[Path]) -> Any:
    if read == "structure":
        return Structure.model_validate(job["structure"])
    stem = "metrics" if read == "relatives" else read
    files = [path for path in inputs if fnmatch(path.stem, stem)]
    if not files:
        raise FileNotFoundError(f"no file is given that holds {read}")
    if read in ("metrics", "relatives"):
        return pd.DataFrame([json.loads(path.read_text(encoding="utf-8")) for path in files])
    if read == "history":
        frames = [read_frame(path).assign(run_id=path.parent.name) for path in files]
    else:
        frames = [read_frame(path) for path in files]
    return pd.concat([frame for frame in frames if len(frame)] or frames, ignore_index=True)
