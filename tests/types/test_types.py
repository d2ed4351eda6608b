"""What mypy may not ask for types: the functions that numba compiles, and nothing else."""

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "flexsurr"
COMPILED = {"njit", "overload", "intrinsic", "implements_rhs", "implements_mapping", "implements_advance"}


def without_types(node: ast.AST, is_compiled: bool = False) -> list[str]:
    """The functions that say no type and are not compiled, in which numba would find them."""
    found = []
    for child in ast.iter_child_nodes(node):
        inside = is_compiled
        if isinstance(child, ast.FunctionDef):
            arguments = [*child.args.posonlyargs, *child.args.args, *child.args.kwonlyargs]
            decorators = {ast.unparse(each).partition("(")[0] for each in child.decorator_list}
            # an overload chooses among functions of a kernel, or of a method, which it alone sees
            chosen = bool(arguments) and arguments[0].arg in ("kernel", "method")
            inside |= bool(COMPILED & decorators) or chosen
            typed = child.returns is not None or any(each.annotation for each in arguments)
            found += [] if inside or typed else [child.name]
        found += without_types(child, inside)
    return found


def test_only_what_numba_compiles_has_no_types():
    """Of everything else mypy, which is strict but for these, asks them."""
    found = {path.name: without_types(ast.parse(path.read_text())) for path in PACKAGE.rglob("*.py")}
    assert {name: functions for name, functions in found.items() if functions} == {}


@pytest.mark.parametrize(
    "text",
    [
        "def f(x): ...",
        "class A:\n    def f(self): ...",
        "@cache\ndef f(x): ...",
        "def f() -> int:\n    def g(): ...",
    ],
)
def test_a_function_without_types_is_found(text):
    assert without_types(ast.parse(text))


def test_a_kernel_needs_none():
    assert without_types(ast.parse("@njit(cache=True)\ndef f(x): ...\ndef g(kernel, x): ...")) == []
