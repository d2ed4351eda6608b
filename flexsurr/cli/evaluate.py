"""Time and judge every model, implementation and integrator under one response; alone on the machine."""

from pathlib import Path

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.cli.selected import selected_surrogates
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation import cost_table


def main(job: Job, selection: Path, runs: Path, output: Path) -> None:
    """Write the cost table of one variant and response."""
    study, variant = part_of(Study, job["part"]), job["variant"]
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    surrogates = selected_surrogates(selection, variant, runs)
    write_frame(output, cost_table(job["study"], study, basis, variant, job["response"], surrogates))


if __name__ == "__main__":
    command(
        main,
        {"selection": "the selected runs", "runs": "the folder of all runs", "output": "the cost table"},
        expected=(EquilibriumNotFound, ArithmeticError),
    )
