"""Sample many shards of the airliner's aerodynamics, one after another: those that are not there."""

from pathlib import Path

from flexsurr.cli.batch import make_all, shards_of
from flexsurr.cli.command import Job, command
from flexsurr.cli.sample import main as sample


def main(job: Job, results: Path, output: Path) -> None:
    """Make the shards of the job below `results`, and write what is made to `output`."""
    make_all(shards_of(job, results, sample, "sample"), results, output)


if __name__ == "__main__":
    command(main, {"results": "the folder of results", "output": "what is made"})
