"""Draw one figure of a study."""

from pathlib import Path
from typing import Any

from flexsurr.cli.command import Job, command
from flexsurr.cli.flying import airliner_of
from flexsurr.cli.products import arguments
from flexsurr.report.figures import DRAW
from flexsurr.report.style import save


def main(job: Job, results: Path, output: Path) -> None:
    """Write the SVG of the job's figure to `output`, and its PNG beside it."""
    known = of_aircraft(job["aircraft"]) if "aircraft" in job else {}
    save(DRAW[job["figure"]](*arguments(job, results, known)), output.with_suffix(""))


def of_aircraft(flight: Job) -> dict[str, Any]:
    """What a figure may show of the aircraft of a job that flies it (`catalogue.OF_AIRCRAFT`)."""
    plane = airliner_of(flight)
    return {"free_modes": plane.modes, "lattice": plane.airframe.lattice, "doublet": plane.settings.doublet}


if __name__ == "__main__":
    command(main, {"results": "the folder of all results", "output": "the SVG"})
