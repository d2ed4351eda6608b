"""Draw the airliner: Figures 16 to 21, its elastic modes, and what its network errs."""

import json
from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.flying import airliner_of
from flexsurr.cli.frames import read_frame
from flexsurr.report.airliner_flight_figures import figure_18, figure_19, figure_20, figure_21
from flexsurr.report.airliner_geometry_figures import figure_16, figure_17, mode_shapes
from flexsurr.report.airliner_learning_figures import coefficient_errors
from flexsurr.report.style import save


def main(job: Job, selection: Path, runs: Path, modes: Path, doublets: Path, folder: Path) -> None:
    """Write the SVG and the PNG of each figure into `folder`."""
    plane = airliner_of(job)
    model = plane.modes.model
    save(figure_16(model, plane.airframe.lattice), folder / "figure_16")
    save(figure_17(model, plane.modes.properties.centre_of_gravity), folder / "figure_17")
    save(mode_shapes(plane.modes, range(1, len(plane.modes.omega_rad_s) + 1)), folder / "elastic_modes")
    save(figure_18(read_frame(modes)), folder / "figure_18")
    chosen = json.loads(selection.read_text(encoding="utf-8"))["network"]["run_id"]
    save(coefficient_errors(read_frame(runs / chosen / "errors.parquet")), folder / "coefficient_errors")
    histories = read_frame(doublets)
    times = plane.settings.doublet
    for control, draw, name in (
        ("elevator", figure_19, "figure_19"),
        ("aileron", figure_20, "figure_20"),
        ("rudder", figure_21, "figure_21"),
    ):
        flown = histories[histories["control"] == control]
        by_model = {str(model): history for model, history in flown.groupby("model")}
        save(draw(by_model, (times.start_s, times.middle_s, times.end_s)), folder / name)


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the chosen network",
            "runs": "the folder of all runs",
            "modes": "eigenvalues",
            "doublets": "time histories",
            "folder": "where the figures go",
        },
    )
