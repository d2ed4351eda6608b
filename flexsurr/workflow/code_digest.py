"""A digest of the source code that a command depends on, so that editing code reruns what it made.

The import graph is read from the sources without running them: every import of a flexsurr module is
followed, wherever in a file it stands. A name imported from a package leads to the module that defines it;
the package's own `__init__` counts only where it holds more than imports, `__all__` and the names that its
`__getattr__` imports when they are asked for, so that a new name in its list does not rerun everything. The
page of runs does not count, for nothing that a command makes depends on it. Within a module every character
counts, comments too; but of the modules that hold commands only the functions that a command uses, so that
commands in one file do not rerun one another.
"""

import ast
import hashlib
import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from symtable import symtable

PACKAGE = "flexsurr"
COMMANDS = "flexsurr.cli."
VIEW = "flexsurr.tracking"
ROOT = Path(__file__).resolve().parents[2]
IMPORT = re.compile(rb"^[ \t]*((?:from[ \t]+[\w.]+[ \t]+)?import[ \t]+(?:\([^)]*\)|[^\n]*))", re.MULTILINE)
"""A statement that imports something, at the beginning of a line."""


def code_digest(part: str, root: Path = ROOT) -> str:
    """Sixteen hex digits of the hash of the sources that a module or "module:function" depends on.

    `root` holds the folder of the package. Raises ModuleNotFoundError if there is no such module,
    AttributeError if it defines no such name.
    """
    digest = hashlib.sha256()
    for each in sorted(parts(part, root)):
        digest.update(each.encode() + b"\0" + _text(root, each) + b"\0")
    return digest.hexdigest()[:16]


def parts(part: str, root: Path = ROOT) -> frozenset[str]:
    """Every flexsurr module that counts towards the digest of `part`; of those with commands, functions."""
    found: set[str] = set()
    waiting = [part]
    while waiting:
        name = waiting.pop()
        if name not in found and not f"{name}.".startswith(f"{VIEW}."):
            found.add(name)
            waiting += _needs(root, name)
    return frozenset(found)


@cache
def _needs(root: Path, part: str) -> tuple[str, ...]:
    module = part.partition(":")[0]
    packages = module.split(".")[:-1]
    parents = [".".join(packages[:depth]) for depth in range(1, len(packages) + 1)]
    needed = dict.fromkeys(_imports(root, module, _statements(root, part)))
    return (*needed, *(parent for parent in parents if not _only_lists_names(root, parent)))


def _statements(root: Path, part: str) -> list[ast.stmt]:
    """What imports something of what counts of a module: all of it, or what makes one of its names."""
    module, _, name = part.partition(":")
    return _used(root, module, name) if name else _import_statements(root, module)


@cache
def _import_statements(root: Path, module: str) -> list[ast.stmt]:
    """Every import of a module. To parse the rest too would take a second for the whole package."""
    found: list[ast.stmt] = []
    for match in IMPORT.finditer(_file(root, module).read_bytes()):
        try:
            found += ast.parse(match[1]).body
        except SyntaxError:  # words of a docstring
            continue
    return found


@cache
def _used(root: Path, module: str, name: str) -> list[ast.stmt]:
    """The statements of a module that define `name`, and in turn each name that they use.

    Of a statement that imports several names, those alone that are used. What a module does beside defining
    names counts always.
    """
    body = _tree(root, module).body
    defining: dict[str, list[ast.stmt]] = {}
    for node in body:
        for defined, statement in _defined(node):
            defining.setdefault(defined, []).append(statement)
    if name not in defining:
        raise AttributeError(f"{module}: defines no {name}")
    used: list[ast.stmt] = [
        node for node in body if isinstance(node, ast.Expr) and not isinstance(node.value, ast.Constant)
    ]
    waiting = [name, *_names(used)]
    while waiting:
        found = defining.pop(waiting.pop(), [])
        used += [node for node in found if node not in used]
        waiting += _names(found)
    return used


def _defined(node: ast.stmt) -> Iterator[tuple[str, ast.stmt]]:
    """The names that a statement defines, each with the part of the statement that does."""
    match node:
        case ast.FunctionDef() | ast.ClassDef():
            yield node.name, node
        case ast.Import():
            for alias in node.names:
                yield alias.asname or alias.name.split(".")[0], ast.copy_location(ast.Import([alias]), node)
        case ast.ImportFrom():
            for alias in node.names:
                only = ast.ImportFrom(node.module, [alias], node.level)
                yield alias.asname or alias.name, ast.copy_location(only, node)
        case _:
            for inner in ast.walk(node):
                if isinstance(inner, ast.Name) and isinstance(inner.ctx, ast.Store):
                    yield inner.id, node


def _names(statements: Iterable[ast.stmt]) -> list[str]:
    """The names of their module that statements use: no variables of their functions."""
    names: list[str] = []
    for statement in statements:
        waiting = [symtable(ast.unparse(statement), "a statement", "exec")]
        while waiting:
            scope = waiting.pop()
            of_module = scope.get_type() == "module"
            names += [each.get_name() for each in scope.get_symbols() if of_module or each.is_global()]
            waiting += scope.get_children()
    return names


def _text(root: Path, part: str) -> bytes:
    """What is written of a module that counts; of an import the names alone."""
    module, _, name = part.partition(":")
    source = _file(root, module).read_bytes()
    if not name:
        return source
    lines, texts = source.splitlines(keepends=True), []
    for node in sorted(_used(root, module, name), key=lambda node: (node.lineno, ast.unparse(node))):
        if isinstance(node, ast.Import | ast.ImportFrom):
            texts.append(ast.unparse(node).encode())
            continue
        decorators = getattr(node, "decorator_list", [])
        first = min([node.lineno, *(each.lineno for each in decorators)])
        texts += lines[first - 1 : node.end_lineno]
    return b"".join(texts)


def _imports(root: Path, module: str, statements: Iterable[ast.stmt]) -> Iterator[str]:
    """The flexsurr modules that `statements` of a module import."""
    for node in (inner for each in statements for inner in ast.walk(each)):
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
        for node in _import_statements(root, source):
            if isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    if (alias.asname or alias.name) == name:
                        return _defining(root, _absolute(root, source, node), alias.name)
    return f"{source}:{name}" if source.startswith(COMMANDS) else source


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


@cache
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
