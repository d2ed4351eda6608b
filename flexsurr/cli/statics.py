"""Static deflection under dead loads, and natural frequencies (Fig. 8, Table 3)."""

from pathlib import Path

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation import natural_frequencies, static_tip


def main(job: Job, statics: Path, frequencies: Path) -> None:
    """Write both tables."""
    study = part_of(Study, job["part"])
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    write_frame(statics, static_tip(study, basis))
    write_frame(frequencies, natural_frequencies(basis))


if __name__ == "__main__":
    command(
        main,
        {"statics": "tip positions", "frequencies": "natural frequencies"},
        expected=(EquilibriumNotFound,),
    )
