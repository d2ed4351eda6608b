"""Every key that a configuration may hold, with meaning, unit, default and what is allowed, as Markdown."""

import argparse
from pathlib import Path

from flexsurr.cli.command import personal
from flexsurr.config.reference import reference


def arguments(parser: argparse.ArgumentParser) -> None:
    """Where it goes."""
    parser.add_argument("--output", type=Path, metavar="FILE", help="written to it; by default printed")


def main(output: Path | None) -> None:
    """Write or print it. Raises LookupError for a key without a description."""
    text = reference()
    if output is None:
        print(text, end="")
    else:
        output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    personal(main, arguments)
