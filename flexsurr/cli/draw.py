"""Draw one figure of a study."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.products import arguments
from flexsurr.report.figures import DRAW
from flexsurr.report.style import save


def main(job: Job, results: Path, output: Path) -> None:
    """Write the SVG of the job's figure to `output`, and its PNG beside it."""
    save(DRAW[job["figure"]](*arguments(job, results)), output.with_suffix(""))


if __name__ == "__main__":
    command(main, {"results": "the folder of all results", "output": "the SVG"})
