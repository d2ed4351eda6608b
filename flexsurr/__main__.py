"""flexsurr <command>: surrogates of flexible structures, from the shell."""

import sys
from importlib import import_module

from flexsurr import __version__
from flexsurr.cli.index import FOR_PEOPLE, function_of, purpose, purposes

EXIT_CODES = """exit codes
  0    done
  1    it cannot be done: one line says why (a traceback is a bug of flexsurr: please report it)
  2    wrong call: an unknown command, option or file
  130  interrupted (Ctrl-C)
  143  terminated (SIGTERM); open files are closed"""


def main() -> None:
    """Run the command that `sys.argv` names, and end the process with its exit code."""
    name, *_ = [*sys.argv[1:], ""]
    if name in ("-h", "--help", ""):
        print(overview())
        sys.exit(0 if name else 2)
    if name == "--version":
        print(__version__)
        sys.exit()
    try:
        module = function_of(name).partition(":")[0]
    except KeyError:
        print(f"flexsurr: no command {name!r}; flexsurr --help lists them", file=sys.stderr)
        sys.exit(2)
    # Its module alone, so that nothing is imported that it does not need.
    import_module(module)
    from flexsurr.cli.command import run

    run(name, purpose(name), sys.argv[2:])


def overview() -> str:
    """Every command in a line, those for people first."""
    every = purposes()
    width = max(map(len, every))
    people = {name for names in FOR_PEOPLE.values() for name in names}
    of_people, of_rules = (
        [f"  {name:<{width}}  {text}" for name, text in every.items() if (name in people) == wanted]
        for wanted in (True, False)
    )
    return "\n".join(
        [
            "usage: flexsurr <command> [options]     flexsurr <command> --help lists its options",
            "",
            "for you",
            *of_people,
            "",
            "for the workflow (snakemake calls them with --job, a file that it writes below results/jobs)",
            *of_rules,
            "",
            EXIT_CODES,
        ]
    )


if __name__ == "__main__":
    main()
