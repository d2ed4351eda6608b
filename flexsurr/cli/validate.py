"""Full and reduced order side by side under the study's tip force, both variants (Fig. 9)."""

from pathlib import Path

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation.validation import validation_table


def main(job: Job, output: Path) -> None:
    """Write the responses of both models."""
    study = part_of(Study, job["part"])
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    write_frame(output, validation_table(study, basis))


if __name__ == "__main__":
    command(main, {"output": "the responses"}, expected=(EquilibriumNotFound,))
