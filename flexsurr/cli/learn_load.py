"""Learn the generalised forces of a study's load, and say what they err by."""

import logging
from pathlib import Path

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation.learned_loads import learn_forces, learned_load_table
from flexsurr.surrogates import save_map
from flexsurr.training import load_dataset

log = logging.getLogger(__name__)


def main(job: Job, manifest: Path, polynomial: Path, network: Path, errors: Path) -> None:
    """Write both maps of the load, learned from the training trajectories, and their held-out errors."""
    study, variant = part_of(Study, job["part"]), job["variant"]
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    dataset = load_dataset(manifest)
    r = basis.modes.shape[1]
    eta, held_out = dataset.x_train[:, :r], dataset.x_validation[:, :r]
    learned = learn_forces(basis, study.evaluation, eta, held_out)
    table = learned_load_table(job["study"], basis, variant, learned, held_out)
    for row in table.itertuples():
        log.info("%s, %s: force within %.2e of its size", row.map, row.form, row.force_relative_error)
    save_map(learned.polynomial, polynomial)
    save_map(learned.network, network)
    write_frame(errors, table)


if __name__ == "__main__":
    command(
        main,
        {
            "manifest": "of the dataset whose configurations are learned from",
            "polynomial": "the forces as a polynomial",
            "network": "the forces as a network",
            "errors": "the held-out errors",
        },
        expected=(EquilibriumNotFound, ValueError),
    )
