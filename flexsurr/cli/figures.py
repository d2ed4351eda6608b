"""Draw figures of a study that show the same data."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.products import arguments
from flexsurr.report.catalogue import FIGURES
from flexsurr.report.figures import DRAW
from flexsurr.report.style import save


def main(job: Job, inputs: list[Path], folder: Path) -> None:
    """Write the SVG and the PNG of each figure that the job names into `folder`."""
    for name in job["figures"]:
        save(DRAW[name](*arguments(FIGURES[name].reads, job, inputs)), folder / name)


if __name__ == "__main__":
    command(main, {"inputs": "what they show …", "folder": "where they go"})
