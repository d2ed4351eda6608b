"""Machine code that several processes need at the same time: compiled once, and kept under a name of its own.

numba numbers the files of a function's overloads in the order in which they come, by an index that it reads,
extends and writes back. Two processes that do so at once take the same number, and whoever reads the index
afterwards may run the code of another overload. Here the name follows from what is compiled, and the code is
written before the index that leads to it. Without locks what is left of the race is an index without one of
two new entries: that overload is compiled once more.

Jobs of one workflow that run side by side need the same kernels. Whoever is first compiles, which takes
seconds; the others wait, and load what it has left.
"""

import fcntl
import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from typing import Any

from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher

from flexsurr.simulation.on_demand import compiling

LOCKS = "compiling"
"""The file in numba's folder of which each overload that is being compiled has one byte locked."""

_compiled_by_numba = Dispatcher.compile
_waits = True


def compile_once() -> None:
    """Have numba do so with whatever it compiles from now on."""
    IndexDataCacheFile.save = _save
    # replaced for all, which types refuse
    Dispatcher.compile = _compile  # type: ignore[assignment, method-assign]


class CompiledElsewhere(Exception):
    """Another process compiles it right now."""


@contextmanager
def unless_compiled_elsewhere() -> Iterator[None]:
    """Within it nothing waits for another process: CompiledElsewhere is raised instead."""
    global _waits
    before, _waits = _waits, False
    try:
        yield
    finally:
        _waits = before


def _save(file: Any, key: Any, data: Any) -> None:
    """Write `data`, the machine code of the overload `key`, to where `file.load(key)` finds it."""
    name = file._data_name(_number(file._dump(key)))
    file._save_data(name, data)
    with _locked(file._cache_path, file._index_name, waits=True):
        overloads = file._load_index()
        overloads[key] = name
        file._save_index(overloads)


def _number(content: bytes) -> int:
    """The same for the same content."""
    return int(hashlib.sha256(content).hexdigest()[:15], 16)


def _compile(dispatcher: Any, sig: Any) -> Any:
    """What numba does, while no other process compiles the same."""
    # numba holds this lock anyway; taken first, no thread waits for it with an overload locked
    with global_compiler_lock, compiling(dispatcher, sig):
        if isinstance(dispatcher._cache, FunctionCache):
            file = dispatcher._cache._cache_file
            key = dispatcher._cache._index_key(sig, dispatcher.targetctx.codegen())
            if key not in file._load_index():
                with _locked(file._cache_path, f"{file._index_name} {sig}"):
                    return _compiled_by_numba(dispatcher, sig)
        return _compiled_by_numba(dispatcher, sig)


@contextmanager
def _locked(folder: str, name: str, waits: bool | None = None) -> Iterator[None]:
    """Alone among processes at what has this name; on a file system without locks, perhaps not alone.

    Locks of bytes end with their process, however it ends, and forks do not inherit them.
    """
    place = _number(name.encode())
    handle = None
    with suppress(OSError):
        handle = _locks(folder)
        try:
            fcntl.lockf(handle, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, place)
        except (BlockingIOError, PermissionError):
            if not (_waits if waits is None else waits):
                raise CompiledElsewhere(name) from None
            fcntl.lockf(handle, fcntl.LOCK_EX, 1, place)
    try:
        yield
    finally:
        if handle is not None:
            with suppress(OSError):
                fcntl.lockf(handle, fcntl.LOCK_UN, 1, place)


@cache
def _locks(folder: str) -> int:
    """Never closed: a process that closes the file anywhere loses all its locks on it."""
    os.makedirs(folder, exist_ok=True)
    return os.open(os.path.join(folder, LOCKS), os.O_RDWR | os.O_CREAT, 0o600)
