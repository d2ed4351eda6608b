"""Files that are either there whole or not at all, and JSON objects in such files."""

import json
import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from flexsurr.storage.errors import DamagedFile, StorageError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to; it takes the place of `path` when the block ends well.

    A process killed inside the block leaves `path` as it was; what it leaves beside is used up by the
    next that writes there. Two processes must not write the same `path` at once.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.name}.part")
    try:
        yield beside
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def write_json(path: Path, content: Any) -> None:
    """Write `content` as JSON, atomically; a number that is not finite is a ValueError."""
    with replacing(path) as beside:
        beside.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def read_json(path: Path, keys: Collection[str] = ()) -> dict[str, Any]:
    """The JSON object at `path`.

    Raises StorageError naming a file that is not there, DamagedFile one that holds no JSON object or one
    without some of `keys`.
    """
    try:
        content = json.loads(read_bytes(path))
    except ValueError:
        raise DamagedFile(f"{path}: damaged or truncated, not JSON") from None
    if not isinstance(content, dict):
        raise DamagedFile(f"{path}: holds no keys with values")
    if missing := [key for key in keys if key not in content]:
        raise DamagedFile(f"{path}: another's, without {', '.join(missing)}")
    return content


def read_bytes(path: Path) -> bytes:
    """The content of `path`; StorageError naming a file that cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise StorageError(f"{path}: cannot be read: {error.strerror}") from None
