"""What a person does with a saved surrogate: look at it, simulate it, see it move."""

import argparse
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from flexsurr import library
from flexsurr.beam import EquilibriumNotFound
from flexsurr.cli.command import for_people
from flexsurr.config.reading import read_yaml
from flexsurr.report.animation import ENDINGS
from flexsurr.storage import replacing
from flexsurr.surrogates import SurrogateFileError


def _surrogate_arguments(parser: argparse.ArgumentParser) -> None:
    """The file."""
    parser.add_argument("file", type=Path, help="weights.npz of a run below results/runs")


@for_people(_surrogate_arguments, SurrogateFileError, OSError)
def surrogate(file: Path) -> None:
    """Describe a saved surrogate: the structure, the states, and the ranges of its training.

    Raises SurrogateFileError for a damaged or foreign file, OSError where there is none.
    """
    print(library.load_surrogate(file))


REFUSED = (SurrogateFileError, OSError, ValueError, EquilibriumNotFound, ArithmeticError)
"""What files, states and loads that are not allowed raise, and what cannot be simulated."""

TABLE, FIGURES = ".csv", (".png", ".svg", ".pdf")


def _simulate_surrogate_arguments(parser: argparse.ArgumentParser) -> None:
    """The file, the response and where it goes."""
    parser.add_argument("file", type=Path, help="weights.npz of a run below results/runs")
    parser.add_argument(
        "--step", type=float, default=0.01, metavar="S", help="seconds between samples, by default 0.01"
    )
    _response_arguments(parser)
    parser.add_argument(
        "--output",
        type=_output,
        required=True,
        metavar="FILE",
        help=f"a {TABLE} or {', '.join(FIGURES)} file",
    )


def _response_arguments(parser: argparse.ArgumentParser) -> None:
    """How long a response lasts, from where it starts, and under what."""
    parser.add_argument("--duration", type=float, required=True, metavar="S", help="seconds to simulate")
    parser.add_argument(
        "--initial",
        type=_state,
        nargs="+",
        default=[],
        metavar="STATE=VALUE",
        help="initial values in the states' units; the others are those at rest",
    )
    parser.add_argument(
        "--load", type=Path, metavar="FILE", help="a YAML file with the keys of a study's evaluation.load"
    )


@for_people(_simulate_surrogate_arguments, *REFUSED)
def simulate_surrogate(
    file: Path,
    duration: float,
    step: float,
    initial: list[tuple[str, float]],
    load: Path | None,
    output: Path,
) -> None:
    """Simulate a saved surrogate, and write its response as a table or a figure.

    What the surrogate was not trained for is a warning on stderr.

    Raises SurrogateFileError, ConfigurationError and OSError for files that are not what they should be,
    ValueError for states and loads that there are not, ArithmeticError for a response that ends early.
    """
    load_values: Any = None if load is None else read_yaml(load)
    with _warnings_of("simulate-surrogate"):
        response = library.load_surrogate(file).simulate(
            duration_s=duration, step_s=step, initial=dict(initial), load=load_values
        )
    with replacing(output) as beside:
        if output.suffix == TABLE:
            response.table().to_csv(beside, index=False)
        else:
            response.plot().savefig(beside, format=output.suffix[1:])
    if not response.trajectory.completed:
        raise ArithmeticError(f"{response.trajectory.reason} at {response.trajectory.end_time_s:g} s")


def _state(text: str) -> tuple[str, float]:
    """The name and the value in STATE=VALUE."""
    name, _, value = text.partition("=")
    return name, float(value)


def _output(text: str) -> Path:
    path = Path(text)
    if path.suffix not in (TABLE, *FIGURES):
        raise argparse.ArgumentTypeError(f"{text}: allowed endings: {TABLE}, {', '.join(FIGURES)}")
    return path


def _animate_arguments(parser: argparse.ArgumentParser) -> None:
    """The surrogates, the response and where it goes."""
    parser.add_argument(
        "files", type=Path, nargs="+", help="weights.npz of runs below results/runs, of one structure"
    )
    parser.add_argument(
        "--frames", type=int, default=150, help="pictures in all, by default 150: 20 a second"
    )
    _response_arguments(parser)
    parser.add_argument(
        "--output", type=Path, required=True, metavar="FILE", help=f"a {' or '.join(ENDINGS)} file"
    )


@for_people(_animate_arguments, *REFUSED)
def animate(
    files: list[Path],
    duration: float,
    frames: int,
    initial: list[tuple[str, float]],
    load: Path | None,
    output: Path,
) -> None:
    """Animate saved surrogates beside the model that they stand for, as a GIF or a page.

    What a surrogate was not trained for is a warning on stderr.

    Raises SurrogateFileError, ConfigurationError and OSError for files that are not what they should be,
    ValueError for states, loads and endings that there are not, and for surrogates of several structures.
    """
    if output.suffix not in ENDINGS:
        raise ValueError(f"--output: {output} is not allowed; allowed endings: {', '.join(ENDINGS)}")
    if frames < 2:
        raise ValueError(f"--frames: {frames} is not allowed; allowed: 2 or more")
    surrogates = [library.load_surrogate(file) for file in files]
    title = _of_one_structure(surrogates)
    values: Any = None if load is None else read_yaml(load)
    given: dict[str, Any] = {"initial": dict(initial), "load": values, "duration_s": duration}
    given["step_s"] = duration / (frames - 1)
    with _warnings_of("animate"):
        reference = surrogates[0].reference(**given)
        responses = [each.simulate(**given) for each in surrogates]
    kinds = [surrogate.saved.surrogate.architecture for surrogate in surrogates]
    named = [
        response.called(kind) if kinds.count(kind) == 1 else response
        for response, kind in zip(responses, kinds, strict=True)
    ]
    library.animate([reference, *named], output, title)


def _of_one_structure(surrogates: list[library.LoadedSurrogate]) -> str:
    """The name of the structure that all of them stand for."""
    first = surrogates[0].saved
    for surrogate in surrogates:
        basis = surrogate.saved.basis
        if basis is None or first.basis is None:
            raise ValueError(f"{surrogate.saved.run_id} stands for no structure that could be seen to move")
        if basis.structure != first.basis.structure or surrogate.state_names != surrogates[0].state_names:
            raise ValueError(f"{surrogate.saved.run_id} stands for another model than {first.run_id}")
    assert first.basis is not None
    return first.basis.structure.name


@contextmanager
def _warnings_of(command: str) -> Iterator[None]:
    """Print what a surrogate was not trained for on stderr, a line each, after the block."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", library.OutOfRange)
        yield
    for warning in caught:
        print(f"flexsurr {command}: {warning.message}", file=sys.stderr)
