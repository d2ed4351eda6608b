"""flexsurr: when does a neural-network surrogate of a flexible structure pay, how much, at what loss?"""

import os
from importlib import import_module
from pathlib import Path
from typing import Any

from flexsurr import kernel_cache

__version__ = "0.1.0"

__all__ = ["load_surrogate"]

if os.name != "posix":
    raise ImportError("flexsurr runs on Linux, on macOS and in WSL: it locks files as POSIX systems do")

kernel_cache.activate()


def load_surrogate(path: str | Path) -> Any:
    """The surrogate that training wrote to `path`: a `flexsurr.library.LoadedSurrogate`.

    Raises SurrogateFileError for a damaged or foreign file, OSError where there is none.
    """
    # By its name and only now: it takes a second, and no job depends on it (`workflow.code_digest`).
    return import_module("flexsurr.library").load_surrogate(path)
