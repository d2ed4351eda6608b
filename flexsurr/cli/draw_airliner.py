"""Draw the airliner: Figures 16 to 21, further doublets, its elastic modes, and the errors of its network."""

import json
from pathlib import Path

import pandas as pd

from flexsurr.cli.command import Job, command
from flexsurr.cli.flying import airliner_of
from flexsurr.cli.frames import read_frame
from flexsurr.report.catalogue import AIRLINER_FIGURES
from flexsurr.report.figures import AIRLINER_DRAW
from flexsurr.report.style import save


def main(
    job: Job, selection: Path, runs: Path, modes: Path, doublets: Path, elastic_modes: Path, folder: Path
) -> None:
    """Write the SVG and the PNG of each figure into `folder`."""
    plane = airliner_of(job)
    chosen = json.loads(selection.read_text(encoding="utf-8"))["network"]["run_id"]
    shown = {
        "structure": plane.modes,
        "lattice": plane.airframe.lattice,
        "times": plane.settings.doublet,
        "modes": read_frame(modes),
        "doublets": read_frame(doublets),
        "elastic_modes": pd.read_csv(elastic_modes, dtype={"paper_mode": "Int64"}),
        "errors": read_frame(runs / chosen / "errors.parquet"),
    }
    for name, product in AIRLINER_FIGURES.items():
        save(AIRLINER_DRAW[name](*(shown[read] for read in product.reads)), folder / name)


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the chosen network",
            "runs": "the folder of all runs",
            "modes": "eigenvalues",
            "doublets": "time histories",
            "elastic_modes": "what each elastic mode is",
            "folder": "where the figures go",
        },
    )
