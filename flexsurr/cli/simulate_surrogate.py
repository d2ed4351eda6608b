"""Simulate a saved surrogate, and write its response as a table or a figure."""

import argparse
import sys
import warnings
from pathlib import Path
from typing import Any

from flexsurr.beam import EquilibriumNotFound
from flexsurr.cli.command import personal
from flexsurr.config.reading import read_yaml
from flexsurr.library import OutOfRange, load_surrogate
from flexsurr.storage import replacing
from flexsurr.surrogates import SurrogateFileError

TABLE, FIGURES = ".csv", (".png", ".svg", ".pdf")


def arguments(parser: argparse.ArgumentParser) -> None:
    """The file, the response and where it goes."""
    parser.add_argument("file", type=Path, help="weights.npz of a run below results/runs")
    parser.add_argument("--duration", type=float, required=True, metavar="S", help="seconds to simulate")
    parser.add_argument(
        "--step", type=float, default=0.01, metavar="S", help="seconds between samples, by default 0.01"
    )
    response_arguments(parser)
    parser.add_argument(
        "--output",
        type=_output,
        required=True,
        metavar="FILE",
        help=f"a {TABLE} or {', '.join(FIGURES)} file",
    )


def response_arguments(parser: argparse.ArgumentParser) -> None:
    """From where a response starts, and under what."""
    parser.add_argument(
        "--initial",
        type=state,
        nargs="+",
        default=[],
        metavar="STATE=VALUE",
        help="initial values in the states' units; the others are those at rest",
    )
    parser.add_argument(
        "--load", type=Path, metavar="FILE", help="a YAML file with the keys of a study's evaluation.load"
    )


def main(
    file: Path,
    duration: float,
    step: float,
    initial: list[tuple[str, float]],
    load: Path | None,
    output: Path,
) -> None:
    """Write the response to `output`; what the surrogate was not trained for is a warning on stderr.

    Raises SurrogateFileError, ConfigurationError and OSError for files that are not what they should be,
    ValueError for states and loads that there are not, ArithmeticError for a response that ends early.
    """
    load_values: Any = None if load is None else read_yaml(load)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", OutOfRange)
        response = load_surrogate(file).simulate(
            duration_s=duration, step_s=step, initial=dict(initial), load=load_values
        )
    for warning in caught:
        print(f"flexsurr simulate-surrogate: {warning.message}", file=sys.stderr)
    with replacing(output) as beside:
        if output.suffix == TABLE:
            response.table().to_csv(beside, index=False)
        else:
            response.plot().savefig(beside, format=output.suffix[1:])
    if not response.trajectory.completed:
        raise ArithmeticError(f"{response.trajectory.reason} at {response.trajectory.end_time_s:g} s")


def state(text: str) -> tuple[str, float]:
    """The name and the value in STATE=VALUE."""
    name, _, value = text.partition("=")
    return name, float(value)


def _output(text: str) -> Path:
    path = Path(text)
    if path.suffix not in (TABLE, *FIGURES):
        raise argparse.ArgumentTypeError(f"{text}: allowed endings: {TABLE}, {', '.join(FIGURES)}")
    return path


if __name__ == "__main__":
    personal(
        main,
        arguments,
        expected=(SurrogateFileError, OSError, ValueError, EquilibriumNotFound, ArithmeticError),
    )
