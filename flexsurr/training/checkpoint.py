"""The state of an unfinished fit on disk, to go on from after a kill."""

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.storage import replacing

NAME = "checkpoint.npz"


def write_checkpoint(folder: Path, belongs_to: dict[str, Any], state: dict[str, Array]) -> None:
    """Write the arrays of `state` whole, with what they belong to (plain JSON values)."""
    with replacing(folder / NAME) as beside, beside.open("wb") as file:
        np.savez(file, allow_pickle=False, belongs_to=np.array(_canonical(belongs_to)), **state)


def read_checkpoint(folder: Path, belongs_to: dict[str, Any]) -> dict[str, Array] | None:
    """The state in `folder`; None if there is none, or a damaged one, or one of another fit."""
    try:
        with (folder / NAME).open("rb") as content, np.load(content, allow_pickle=False) as file:
            state = dict(file)
    except (OSError, EOFError, ValueError, zipfile.BadZipFile):
        return None
    return state if str(state.pop("belongs_to", "")) == _canonical(belongs_to) else None


def remove_checkpoint(folder: Path) -> None:
    """Remove the checkpoint in `folder`, if there is one."""
    (folder / NAME).unlink(missing_ok=True)


def _canonical(values: dict[str, Any]) -> str:
    return json.dumps(values, sort_keys=True)
