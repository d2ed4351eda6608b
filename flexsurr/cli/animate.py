"""Animate saved surrogates beside the model that they stand for, as a GIF or a page."""

import argparse
import sys
import warnings
from pathlib import Path
from typing import Any

from flexsurr.beam import EquilibriumNotFound
from flexsurr.cli.command import personal
from flexsurr.cli.simulate_surrogate import response_arguments
from flexsurr.config.reading import read_yaml
from flexsurr.library import LoadedSurrogate, OutOfRange, animate, load_surrogate
from flexsurr.report.animation import ENDINGS
from flexsurr.surrogates import SurrogateFileError


def arguments(parser: argparse.ArgumentParser) -> None:
    """The surrogates, the response and where it goes."""
    parser.add_argument(
        "files", type=Path, nargs="+", help="weights.npz of runs below results/runs, of one structure"
    )
    parser.add_argument("--duration", type=float, required=True, metavar="S", help="seconds to simulate")
    parser.add_argument(
        "--frames", type=int, default=150, help="pictures in all, by default 150: 20 a second"
    )
    response_arguments(parser)
    parser.add_argument(
        "--output", type=Path, required=True, metavar="FILE", help=f"a {' or '.join(ENDINGS)} file"
    )


def main(
    files: list[Path],
    duration: float,
    frames: int,
    initial: list[tuple[str, float]],
    load: Path | None,
    output: Path,
) -> None:
    """Write the responses, moving, to `output`; what a surrogate was not trained for is a warning on stderr.

    Raises SurrogateFileError, ConfigurationError and OSError for files that are not what they should be,
    ValueError for states, loads and endings that there are not, and for surrogates of several structures.
    """
    if output.suffix not in ENDINGS:
        raise ValueError(f"--output: {output} is not allowed; allowed endings: {', '.join(ENDINGS)}")
    if frames < 2:
        raise ValueError(f"--frames: {frames} is not allowed; allowed: 2 or more")
    surrogates = [load_surrogate(file) for file in files]
    title = _of_one_structure(surrogates)
    values: Any = None if load is None else read_yaml(load)
    given: dict[str, Any] = {"initial": dict(initial), "load": values, "duration_s": duration}
    given["step_s"] = duration / (frames - 1)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", OutOfRange)
        reference = surrogates[0].reference(**given)
        responses = [each.simulate(**given) for each in surrogates]
    for warning in caught:
        print(f"flexsurr animate: {warning.message}", file=sys.stderr)
    kinds = [surrogate.saved.surrogate.architecture for surrogate in surrogates]
    named = [
        response.called(kind) if kinds.count(kind) == 1 else response
        for response, kind in zip(responses, kinds, strict=True)
    ]
    animate([reference, *named], output, title)


def _of_one_structure(surrogates: list[LoadedSurrogate]) -> str:
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


if __name__ == "__main__":
    personal(
        main,
        arguments,
        expected=(SurrogateFileError, OSError, ValueError, EquilibriumNotFound, ArithmeticError),
    )
