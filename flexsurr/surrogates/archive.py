"""Files of arrays with a JSON header that says what they are: how everything that is learned is kept."""

import json
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from flexsurr.storage import DamagedFile, replacing

Kept = TypeVar("Kept")


class SurrogateFileError(DamagedFile):
    """A file that cannot be read as a surrogate; the message names it."""


def write_archive(
    path: str | Path, form: str, header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]
) -> None:
    """Write an .npz of `arrays`, its header {"format": form, **header}, whole or not at all."""
    text = np.array(json.dumps({"format": form, **header}))
    with replacing(Path(path)) as beside, beside.open("wb") as file:
        np.savez(file, allow_pickle=False, header=text, **arrays)


def read_archive(
    path: str | Path, form: str, what: str, build: Callable[[dict[str, Any], dict[str, Any]], Kept]
) -> Kept:
    """What `build(header, arrays)` makes of the file; arrays are integers, or contiguous finite float64.

    Raises SurrogateFileError for a damaged or foreign file, saying that it is not `what`; OSError for none.
    """
    arrays = _arrays(path)
    try:
        header = json.loads(str(arrays.pop("header")))
        if header["format"] != form:
            raise SurrogateFileError(f"{path}: format {header['format']!r}, expected {form!r}")
        return build(header, {name: _numbers(name, array) for name, array in arrays.items()})
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        detail = f"no {error}" if isinstance(error, KeyError) else error
        raise SurrogateFileError(f"{path}: not {what} of flexsurr ({detail})") from None


def form_of(path: str | Path) -> str:
    """What form of an archive a file is, "" where it has none.

    Raises SurrogateFileError for a file that is no .npz, OSError for none.
    """
    try:
        return str(json.loads(str(_arrays(path)["header"]))["format"])
    except (KeyError, TypeError, ValueError):
        return ""


def _arrays(path: str | Path) -> dict[str, np.ndarray]:
    try:
        with Path(path).open("rb") as content, np.load(content, allow_pickle=False) as file:
            return dict(file)
    except FileNotFoundError:
        raise
    except (OSError, EOFError, ValueError, TypeError, RuntimeError, zipfile.BadZipFile) as error:
        raise SurrogateFileError(f"{path}: not a readable .npz file ({error})") from None


def _numbers(name: str, array: np.ndarray) -> np.ndarray:
    if np.issubdtype(array.dtype, np.integer):
        return array
    numbers = np.ascontiguousarray(array, dtype=np.float64)
    if not np.all(np.isfinite(numbers)):
        raise ValueError(f"{name} that are not finite")
    return numbers
