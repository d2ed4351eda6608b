"""A digest of the source code that a command depends on, so that editing code reruns what it made.

The import graph is read from the sources without running them: every import of a flexsurr module is
followed, wherever in a file it stands. A name imported from a package leads to the module that defines
it; the package's own `__init__` counts only where it holds more than imports, `__all__` and the names that
its `__getattr__` imports when they are asked for, so that a new name in its list does not rerun
everything. The page of runs does not count, for nothing that a command makes depends on it. Within a
module every character counts, comments too.
"""

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

PACKAGE = "flexsurr"
VIEW = "flexsurr.tracking"
ROOT = Path(__file__).resolve().parents[2]


def code_digest(module: str, root: Path = ROOT) -> str:
    """Sixteen hex digits of the hash of the sources that `module` depends on, itself included.

    `root` holds the folder of the package. Raises ModuleNotFoundError if there is no such module.
    """
    digest = hashlib.sha256()
    for name in sorted(modules(module, root)):
        digest.update(name.encode() + b"\0" + _file(root, name).read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def modules(module: str, root: Path = ROOT) -> frozenset[str]:
    """Every flexsurr module that counts towards the digest of `module`."""
    found: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name not in found and not f"{name}.".startswith(f"{VIEW}."):
            found.add(name)
            waiting += _needs(root, name)
    return frozenset(found)


@cache
def _needs(root: Path, module: str) -> tuple[str, ...]:
    needed = dict.fromkeys(_imports(root, module))
    parts = module.split(".")
    parents = [".".join(parts[:depth]) for depth in range(1, len(parts))]
    return (*needed, *(parent for parent in parents if not _only_lists_names(root, parent)))


def _imports(root: Path, module: str) -> Iterator[str]:
    for node in ast.walk(_tree(root, module)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.split(".")[0] == PACKAGE)
        elif isinstance(node, ast.ImportFrom):
            source = _absolute(root, module, node)
            if source.split(".")[0] == PACKAGE:
                yield from (_defining(root, source, alias.name) for alias in node.names)


def _defining(root: Path, source: str, name: str) -> str:
    """The module that `from source import name` leads to, through packages that only pass it on."""
    submodule = f"{source}.{name}"
    if _exists(root, submodule):
        return submodule
    if _is_package(root, source) and _only_lists_names(root, source):
        for node in ast.walk(_tree(root, source)):
            if isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    if (alias.asname or alias.name) == name:
                        return _defining(root, _absolute(root, source, node), alias.name)
    return source


def _absolute(root: Path, module: str, node: ast.ImportFrom) -> str:
    if node.level == 0:
        return node.module or ""
    parts = module.split(".")
    kept = len(parts) - node.level + (1 if _is_package(root, module) else 0)
    return ".".join([*parts[:kept], *([node.module] if node.module else [])])


def _only_lists_names(root: Path, package: str) -> bool:
    """Whether the package's `__init__` only passes names on: at once, or by `__getattr__` when asked."""
    return all(_passes_names_on(node) for node in _tree(root, package).body)


def _passes_names_on(node: ast.stmt) -> bool:
    match node:
        case ast.Expr(value=ast.Constant()) | ast.Import() | ast.ImportFrom():
            return True
        case ast.Assign(targets=[ast.Name(id="__all__" | "_MODULES")]):
            return True
        case ast.If(test=ast.Name(id="TYPE_CHECKING"), orelse=[]):
            return all(_passes_names_on(inner) for inner in node.body)
        case ast.FunctionDef(name="__getattr__"):
            return True
    return False


def _is_package(root: Path, module: str) -> bool:
    return (root / Path(*module.split(".")) / "__init__.py").is_file()


def _exists(root: Path, module: str) -> bool:
    return _is_package(root, module) or (root / Path(*module.split("."))).with_suffix(".py").is_file()


def _file(root: Path, module: str) -> Path:
    path = root / Path(*module.split("."))
    if _is_package(root, module):
        return path / "__init__.py"
    if not path.with_suffix(".py").is_file():
        raise ModuleNotFoundError(f"{module}: no such module below {root}")
    return path.with_suffix(".py")


@cache
def _tree(root: Path, module: str) -> ast.Module:
    return ast.parse(_file(root, module).read_bytes())
