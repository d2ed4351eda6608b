"""Networks of the user's own: `architecture: my_models.py:MyField` names a file and a class in it.

What can be said of them without running them. `flexsurr.surrogates.torch_module` runs them.
"""

import ast
import hashlib
import re
from pathlib import Path
from typing import NamedTuple

from flexsurr.config.errors import nearest

WRITTEN = re.compile(r"(?P<file>[^:\s]+\.py):(?P<name>[A-Za-z_]\w*)")


class OwnNetwork(NamedTuple):
    """A file, relative to the project's root, and a class in it."""

    file: str
    name: str

    def __str__(self) -> str:
        """As a sweep names it."""
        return f"{self.file}:{self.name}"


def own_network(architecture: str) -> OwnNetwork | None:
    """The file and class that `architecture` names; None where it is one of flexsurr's own."""
    found = WRITTEN.fullmatch(architecture)
    return None if found is None else OwnNetwork(found["file"], found["name"])


def read_source(root: Path, network: OwnNetwork) -> bytes:
    """The content of its file. Raises ValueError, of one line, where none can be read below `root`."""
    path = (root / network.file).resolve()
    if not path.is_relative_to(root.resolve()):
        raise ValueError(f"{network}: the file lies outside the project; allowed: a path below its root")
    if not path.is_file():
        raise ValueError(f"{network}: no file {network.file} below the project's root, {root.resolve()}")
    try:
        return path.read_bytes()
    except OSError as error:
        raise ValueError(f"{network}: {network.file} cannot be read: {error.strerror}") from None


def sha256(source: bytes) -> str:
    """The hash by which a run knows the file that it was trained with."""
    return hashlib.sha256(source).hexdigest()


def check_source(network: OwnNetwork, source: bytes) -> None:
    """Raise ValueError, of one line, where `source` is not Python or defines no such class."""
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError) as error:
        line = f", line {error.lineno}" if isinstance(error, SyntaxError) else ""
        reason = error.msg if isinstance(error, SyntaxError) else error
        raise ValueError(f"{network.file}{line}: not Python ({reason})") from None
    classes = [node.name for node in tree.body if isinstance(node, ast.ClassDef)]
    if network.name not in classes:
        raise ValueError(
            f"{network}: the file defines no class {network.name}{nearest(network.name, classes)}; "
            f"allowed: {', '.join(classes) or 'none is there'}"
        )
