"""Simulate many shards of a dataset, one after another: those of a batch that are not there."""

from pathlib import Path

from flexsurr.beam import EquilibriumNotFound
from flexsurr.cli.batch import make_all, shards_of
from flexsurr.cli.command import Job, command
from flexsurr.cli.simulate import main as simulate

REFUSED = (EquilibriumNotFound, ArithmeticError)


def main(job: Job, results: Path, output: Path) -> None:
    """Make the shards of the job below `results`, and write what is made to `output`."""
    make_all(shards_of(job, results, simulate, "simulate"), results, output, REFUSED)


if __name__ == "__main__":
    command(main, {"results": "the folder of results", "output": "what is made"})
