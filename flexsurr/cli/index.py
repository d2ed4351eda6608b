"""Which command stands in which module of this package, as the function of its name."""

import ast
from pathlib import Path

FOR_PEOPLE = {
    "studies": ("check", "new-study", "reference"),
    "surrogates": ("surrogate", "simulate-surrogate", "animate"),
    "export": ("export",),
    "tracking": ("track",),
}
FOR_RULES = {
    "datasets": ("ingest", "manifest"),
    "trajectories": ("simulate", "shards"),
    "samples": ("sample", "sample-shards"),
    "training": ("train", "train-map"),
    "scoring": ("score", "score-map"),
    "selection": ("select",),
    "trials": ("trials", "map-trials"),
    "evaluation": (
        "statics",
        "validate",
        "respond",
        "learn-load",
        "rehearse",
        "evaluate",
        "rivals",
        "watch",
        "rollouts",
        "rollout-cost",
    ),
    "flight": ("accuracy", "fly", "fly-references", "fly-randomly"),
    "report": ("draw", "tabulate", "join", "answer"),
    "tracking": ("store",),
}

_MODULES = {
    name: module for index in (FOR_PEOPLE, FOR_RULES) for module, names in index.items() for name in names
}


def function_of(command: str) -> str:
    """The function of a command, as "module:function"; KeyError where there is none of that name."""
    return f"flexsurr.cli.{_MODULES[command]}:{command.replace('-', '_')}"


def purposes() -> dict[str, str]:
    """What each command does in one line, by its name; read from the sources, which need not be imported."""
    return {name: purpose(name) for name in sorted(_MODULES)}


def purpose(command: str) -> str:
    """The first line of what a command says of itself."""
    module, _, function = function_of(command).partition(":")
    source = Path(__file__).with_name(f"{module.rpartition('.')[2]}.py").read_text(encoding="utf-8")
    (definition,) = (
        node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef) and node.name == function
    )
    return (ast.get_docstring(definition) or "").split("\n")[0]
