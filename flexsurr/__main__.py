"""flexsurr <command>: surrogates of flexible structures, from the shell."""

import gc
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

COLLECTED_AFTER = 50_000
"""New objects between two collections of garbage; Python's own 700 suit processes that allocate little."""


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
    # The collector would look again and again through what is imported and compiled, which stays: a tenth of
    # the time of either.
    gc.disable()
    # Its module alone, so that nothing is imported that it does not need.
    import_module(module)
    from flexsurr.cli.command import run

    gc.freeze()
    gc.set_threshold(COLLECTED_AFTER)
    gc.enable()
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
