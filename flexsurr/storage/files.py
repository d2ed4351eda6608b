"""Files: there whole or not at all, JSON objects in them, and one process at a time in a folder."""

import errno
import fcntl
import json
import logging
import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


class StorageError(Exception):
    """A file that must not be used; the message names it and says why."""


class DamagedFile(StorageError):
    """A file that is not what was written there: damaged, truncated or another's. It can be made again."""


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


log = logging.getLogger(__name__)

# What file systems answer that know no locks (some network and parallel ones), or no locks of folders.
NO_LOCKS = {errno.EBADF, errno.EINVAL, errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP}


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep a second process out: one killed with its Snakemake may still be at work on the same run.

    A file system without locks is a warning.
    """
    folder.mkdir(parents=True, exist_ok=True)
    handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            _lock(handle)
        except OSError as error:
            if error.errno not in NO_LOCKS:
                raise
            log.warning("%s: no locks here (%s); goes on without one", folder, error.strerror)
        yield
    finally:
        os.close(handle)


def _lock(handle: int) -> None:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        log.info("waiting for another process that trains this run")
        fcntl.flock(handle, fcntl.LOCK_EX)
