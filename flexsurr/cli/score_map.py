"""Score one run of a map: what training says of it on held-out samples is all."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.runs import read_run
from flexsurr.storage import write_json


def main(job: Job, fit: Path, weights: Path, best: Path, manifest: list[Path], output: Path) -> None:
    """Write the run's metrics. Of a map there is no `manifest`; its weights are read by rule `accuracy`."""
    write_json(output, read_run(fit))


if __name__ == "__main__":
    command(
        main,
        {
            "fit": "what training says of the run",
            "weights": "the surrogate that it keeps",
            "best": "the one that validated best",
            "manifest": "none …",
            "output": "its metrics",
        },
    )
