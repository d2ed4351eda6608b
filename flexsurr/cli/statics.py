"""Static deflection under dead loads, natural frequencies, and shapes (Fig. 8, Table 3)."""

from pathlib import Path

import pandas as pd

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation.shapes import shapes_table
from flexsurr.evaluation.statics import natural_frequencies, static_tip


def main(job: Job, statics: Path, frequencies: Path, shapes: Path) -> None:
    """Write the tables."""
    study = part_of(Study, job["part"])
    structures = [Structure.model_validate(s) for s in (job["structure"], *job["frequencies_also_of"])]
    bases = [reduce(structure, study.reduction) for structure in structures]
    write_frame(statics, static_tip(study, bases[0]))
    write_frame(frequencies, pd.concat([natural_frequencies(basis) for basis in bases], ignore_index=True))
    write_frame(shapes, shapes_table(study, bases[0]))


if __name__ == "__main__":
    command(
        main,
        {"statics": "tip positions", "frequencies": "natural frequencies", "shapes": "shapes"},
        expected=(EquilibriumNotFound,),
    )
