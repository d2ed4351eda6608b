"""Responses of the selected surrogates beside the reference's, and their energies (Figs. 10, 12 to 15)."""

from pathlib import Path

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.cli.selected import selected_surrogates
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation.cases import Response
from flexsurr.evaluation.energy import energy_table
from flexsurr.evaluation.responses import response_table


def main(
    job: Job, selection: Path, runs: Path, free: Path, forced: Path, sustained: Path, energy: Path
) -> None:
    """Write the free, forced and sustained response and the energies of one variant."""
    study, variant = part_of(Study, job["part"]), job["variant"]
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    surrogates = selected_surrogates(selection, variant, runs)
    responses: dict[Response, Path] = {"free": free, "forced": forced, "sustained": sustained}
    for response, path in responses.items():
        write_frame(path, response_table(study, basis, variant, response, surrogates))
    write_frame(energy, energy_table(study, basis, variant, surrogates))


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the selected runs",
            "runs": "the folder of all runs",
            "free": "the free response",
            "forced": "the forced response",
            "sustained": "the response to the longest load",
            "energy": "the energies",
        },
        expected=(EquilibriumNotFound, ArithmeticError),
    )
