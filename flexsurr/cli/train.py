"""Train one surrogate of a field: a trial of a sweep on one dataset."""

from pathlib import Path

import numpy as np

from flexsurr.beam import EquilibriumNotFound, ModalBasis, reduce
from flexsurr.cli.command import Job, command
from flexsurr.cli.training_run import FILES, Task, run
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.config.trial import Trial, configurations_of, trial_of
from flexsurr.storage import read_manifest
from flexsurr.surrogates import Surrogate
from flexsurr.training import ShardedDataset, fit
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.dataset import SampleSource
from flexsurr.training.saved_surrogate import SavedSurrogate, save_surrogate


def main(job: Job, data: list[Path], store: Path, folder: Path) -> None:
    """Train on the dataset in the folder `data`; a trial that samples configurations has none."""
    trial = trial_of(**job["trial"])
    run(job, trial, lambda: _task(job, trial, data, folder), store, folder)


def _task(job: Job, trial: Trial, data: list[Path], folder: Path) -> Task:
    basis, configurations = _basis(job), configurations_of(trial)
    dataset: SampleSource
    if configurations is None or basis is None:
        dataset = ShardedDataset(read_manifest(data[0] / "manifest.json"))
    else:
        ranges = part_of(Study, job["part"]).dataset.initial_conditions
        dataset = configuration_samples(basis, job["variant"], ranges, configurations)
    low, high = (
        np.array(values)[: len(dataset.state_names)] for values in (dataset.scales.low, dataset.scales.high)
    )

    def save(surrogate: Surrogate, path: Path) -> None:
        saved = SavedSurrogate(surrogate, job["study"], job["variant"], job["run_id"], low, high, basis)
        save_surrogate(saved, path)

    return Task(dataset.sha256, lambda report: fit(trial, dataset, folder, report), save)


def _basis(job: Job) -> ModalBasis | None:
    """The modes of the study's structure; None where its data are the user's own."""
    if "structure" not in job:
        return None
    return reduce(Structure.model_validate(job["structure"]), part_of(Study, job["part"]).reduction)


if __name__ == "__main__":
    command(
        main,
        {"data": "the folder of the dataset; none for configurations …", **FILES},
        expected=(EquilibriumNotFound,),
    )
