"""Say what a saved surrogate is: what it stands for, its states, and where it was trained."""

import argparse
from pathlib import Path

from flexsurr.cli.command import personal
from flexsurr.library import load_surrogate
from flexsurr.surrogates import SurrogateFileError


def arguments(parser: argparse.ArgumentParser) -> None:
    """The file."""
    parser.add_argument("file", type=Path, help="weights.npz of a run below results/runs")


def main(file: Path) -> None:
    """Print it. Raises SurrogateFileError for a damaged or foreign file, OSError where there is none."""
    print(load_surrogate(file))


if __name__ == "__main__":
    personal(main, arguments, expected=(SurrogateFileError, OSError))
