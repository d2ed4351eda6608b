"""Each overload's machine code in a file of its own name, for processes that compile at the same time.

numba numbers these files in the order in which they come, by an index that it reads, extends and writes
back. Two processes that do so at once take the same number, and whoever reads the index afterwards may run
the code of another overload. Here the name follows from what is compiled, and the code is written before the
index that leads to it. What is left of the race is an index without one of two new entries: that overload is
compiled once more.
"""

import hashlib
from typing import Any

from numba.core.caching import IndexDataCacheFile


def name_by_content() -> None:
    """Have numba write the machine code of whatever it compiles from now on under such a name."""
    IndexDataCacheFile.save = _save


def _save(file: Any, key: Any, data: Any) -> None:
    """Write `data`, the machine code of the overload `key`, to where `file.load(key)` finds it."""
    number = int(hashlib.sha256(file._dump(key)).hexdigest()[:15], 16)
    name = file._data_name(number)
    file._save_data(name, data)
    overloads = file._load_index()
    overloads[key] = name
    file._save_index(overloads)
