"""Train one surrogate of a map: a trial of a sweep on samples."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.training_run import FILES, Task, run
from flexsurr.config.trial import Map, trial_of
from flexsurr.storage import read_all_samples
from flexsurr.surrogates import save_map
from flexsurr.training import fit_map
from flexsurr.training.map_data import map_data


def main(job: Job, data: list[Path], store: Path, folder: Path) -> None:
    """Train on the samples in the folder `data`."""
    trial = trial_of(**job["trial"])
    assert isinstance(trial, Map)  # a study of samples has no others
    run(job, trial, lambda: _task(job, trial, data[0], folder), store, folder)


def _task(job: Job, trial: Map, data: Path, folder: Path) -> Task:
    shards = [data / f"shard-{number:04d}.parquet" for number in range(job["shards"])]
    samples = read_all_samples(shards, job["configuration"], job["samples"])
    dataset = map_data(samples, job["held_out"], job["seed"])
    return Task(dataset.sha256, lambda report: fit_map(trial, dataset, folder, report), save_map)


if __name__ == "__main__":
    command(main, {"data": "the folder of the samples …", **FILES})
