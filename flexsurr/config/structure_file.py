"""The file of a structure, with the table beside it."""

from pathlib import Path, PurePosixPath
from typing import Any

from flexsurr.config.along_span import with_table
from flexsurr.config.merging import Source, build
from flexsurr.config.reading import read_yaml
from flexsurr.config.structure import Structure


def structure_values(path: Path, shown: str) -> dict[str, Any]:
    """What the file at `path` says, called `shown` in errors, and the CSV file that it names.

    Raises ConfigurationError for a file that is missing or cannot be read.
    """
    return with_table(read_yaml(path, shown), path.parent, str(PurePosixPath(shown).parent))


def read_structure(path: str | Path) -> Structure:
    """The structure in the file at `path`. Raises ConfigurationError with a line for each mistake."""
    return build(Structure, [Source(str(path), structure_values(Path(path), str(path)))])
