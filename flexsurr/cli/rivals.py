"""Time and judge every run of one number of modes beside the compiled reduced model; alone on the machine."""

import logging
from pathlib import Path

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.cli.runs import read_run
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation.rivals import Rival, name_of, rivals_table
from flexsurr.surrogates import load

log = logging.getLogger(__name__)


def main(job: Job, runs: Path, output: Path) -> None:
    """Write the table of the job's runs that have finished."""
    study = part_of(Study, job["part"])
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    rivals = []
    for key in job["runs"]:
        metrics = read_run(runs / key / "metrics.json")
        if metrics["status"] == "finished":
            rivals.append(Rival(key, name_of(metrics), load(runs / key / "weights.npz")))
        else:
            log.warning("%s: %s %s, %s", key, name_of(metrics), metrics["status"], metrics["reason"])
    write_frame(output, rivals_table(study, basis, "hamiltonian", rivals))


if __name__ == "__main__":
    command(
        main,
        {"runs": "the folder of all runs", "output": "the table"},
        expected=(EquilibriumNotFound, ArithmeticError),
    )
