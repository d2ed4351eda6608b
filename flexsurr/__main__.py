"""flexsurr <command>: surrogates of flexible structures, from the shell."""

import ast
import runpy
import sys
from pathlib import Path

from flexsurr import __version__

COMMANDS = Path(__file__).parent / "cli"
FOR_PEOPLE = (
    "animate",
    "check",
    "export",
    "new-study",
    "reference",
    "simulate-surrogate",
    "surrogate",
    "track",
)
EXIT_CODES = """exit codes
  0    done
  1    it cannot be done: one line says why (a traceback is a mistake of ours: please report it)
  2    called wrongly: an unknown command, option or file
  130  interrupted (Ctrl-C)
  143  told to end (SIGTERM); what was open is closed"""


def main() -> None:
    """Run the command that `sys.argv` names, and end the process with its exit code."""
    name, *_ = [*sys.argv[1:], ""]
    if name in ("-h", "--help", ""):
        print(overview())
        sys.exit(0 if name else 2)
    if name == "--version":
        print(__version__)
        sys.exit()
    if not _module(name).isidentifier() or _purpose(COMMANDS / f"{_module(name)}.py") is None:
        print(f"flexsurr: no command {name!r}; flexsurr --help lists them", file=sys.stderr)
        sys.exit(2)
    del sys.argv[1]
    # A command is its module run as a script, so nothing is imported that it does not need.
    runpy.run_module(f"flexsurr.cli.{_module(name)}", run_name="__main__", alter_sys=True)


def commands() -> dict[str, str]:
    """What each command does in one line, by its name; read from the sources, which need not be imported."""
    purposes = {path.stem.replace("_", "-"): _purpose(path) for path in sorted(COMMANDS.glob("*.py"))}
    return {name: purpose for name, purpose in purposes.items() if purpose is not None}


def _purpose(path: Path) -> str | None:
    """The first line of a module that can be run as a script; None for any other, or where there is none."""
    if not path.is_file():
        return None
    tree = ast.parse(path.read_bytes())
    if not any(isinstance(node, ast.If) and "__main__" in ast.unparse(node.test) for node in tree.body):
        return None
    return (ast.get_docstring(tree) or "").split("\n")[0]


def _module(name: str) -> str:
    return name.replace("-", "_")


def overview() -> str:
    """Every command in a line, those for people first."""
    every = commands()
    width = max(map(len, every))
    of_people, of_rules = (
        [f"  {name:<{width}}  {text}" for name, text in every.items() if (name in FOR_PEOPLE) == people]
        for people in (True, False)
    )
    return "\n".join(
        [
            "usage: flexsurr <command> [options]     flexsurr <command> --help says which",
            "",
            "for you",
            *of_people,
            "",
            "for the workflow (snakemake calls them, with a --job FILE that it writes below results/jobs)",
            *of_rules,
            "",
            EXIT_CODES,
        ]
    )


if __name__ == "__main__":
    main()
