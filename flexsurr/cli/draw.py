"""Draw figures of a study: those that show what one rule has made."""

from pathlib import Path
from typing import Any

from flexsurr.cli.command import Job, command
from flexsurr.cli.products import arguments
from flexsurr.report.figures import DRAW
from flexsurr.report.style import save


def main(job: Job, results: Path, folder: Path) -> None:
    """Write SVG and PNG of each figure of the job to `folder`."""
    known: dict[str, Any] = {}
    for name, figure in job.items():
        if "aircraft" in figure and not known:  # a study has one, and its modes take a second
            known = of_aircraft(figure["aircraft"])
        save(DRAW[name](*arguments(figure, results, known)), folder / name)


def of_aircraft(flight: Job) -> dict[str, Any]:
    """What a figure may show of the aircraft of a job that flies it (`catalogue.OF_AIRCRAFT`)."""
    # here, for it takes a second that no figure of another study needs
    from flexsurr.cli.flying import airliner_of

    plane = airliner_of(flight)
    return {"free_modes": plane.modes, "lattice": plane.airframe.lattice, "doublet": plane.settings.doublet}


if __name__ == "__main__":
    command(main, {"results": "the folder of all results", "folder": "of the figures"})
