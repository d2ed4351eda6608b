"""flexsurr <command>: surrogates of flexible structures, from the shell."""

import ast
import runpy
import sys
from pathlib import Path

from flexsurr import __version__

COMMANDS = Path(__file__).parent / "cli"
FOR_PEOPLE = ("check", "surrogate", "simulate-surrogate")
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
    if name not in commands():
        print(f"flexsurr: no command {name!r}; flexsurr --help lists them", file=sys.stderr)
        sys.exit(2)
    del sys.argv[1]
    # A command is its module run as a script, so nothing is imported that it does not need.
    runpy.run_module(f"flexsurr.cli.{name.replace('-', '_')}", run_name="__main__", alter_sys=True)


def commands() -> dict[str, str]:
    """What each command does in one line, by its name; read from the sources, which need not be imported."""
    found = {}
    for path in sorted(COMMANDS.glob("*.py")):
        tree = ast.parse(path.read_bytes())
        if any(isinstance(node, ast.If) and "__main__" in ast.unparse(node.test) for node in tree.body):
            found[path.stem.replace("_", "-")] = (ast.get_docstring(tree) or "").splitlines()[0]
    return found


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
