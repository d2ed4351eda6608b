"""Draw figures of a study that show the same data."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.products import arguments
from flexsurr.report import FIGURES, save


def main(job: Job, inputs: list[Path], folder: Path) -> None:
    """Write the SVG and the PNG of each figure that the job names into `folder`."""
    for name in job["figures"]:
        figure = FIGURES[name]
        save(figure.make(*arguments(figure.reads, job, inputs)), folder / name)


if __name__ == "__main__":
    command(main, {"inputs": "what they show …", "folder": "where they go"})
