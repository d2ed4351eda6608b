"""The state of an unfinished fit on disk, to go on from after a kill."""

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.storage import replacing

NAME = "checkpoint.npz"


def write_checkpoint(folder: Path, belongs_to: dict[str, Any], **states: dict[str, Array]) -> None:
    """Write the arrays of the named `states` whole, with what they belong to (plain JSON values)."""
    arrays = {f"{name}/{key}": array for name, state in states.items() for key, array in state.items()}
    with replacing(folder / NAME) as beside, beside.open("wb") as file:
        np.savez(file, allow_pickle=False, belongs_to=np.array(_canonical(belongs_to)), **arrays)


def read_checkpoint(folder: Path, belongs_to: dict[str, Any]) -> dict[str, dict[str, Array]] | None:
    """The states in `folder` by name; None if there are none, or damaged ones, or those of another fit."""
    try:
        with (folder / NAME).open("rb") as content, np.load(content, allow_pickle=False) as file:
            arrays = dict(file)
    except (OSError, EOFError, ValueError, TypeError, RuntimeError, zipfile.BadZipFile):
        return None
    if str(arrays.pop("belongs_to", "")) != _canonical(belongs_to):
        return None
    states: dict[str, dict[str, Array]] = {}
    for place, array in arrays.items():
        name, key = place.split("/")
        states.setdefault(name, {})[key] = array
    return states


def remove_checkpoint(folder: Path) -> None:
    """Remove the checkpoint in `folder`, if there is one."""
    (folder / NAME).unlink(missing_ok=True)


def _canonical(values: dict[str, Any]) -> str:
    return json.dumps(values, sort_keys=True)
