"""One process at a time at work on a folder.

Locks are those of Linux, macOS and other Unixes (`flock`).
"""

import errno
import fcntl
import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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
