"""Train one surrogate, of a field or of a map: a trial of a sweep on one dataset."""

import logging
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexsurr.beam import EquilibriumNotFound, ModalBasis, reduce
from flexsurr.cli.alone import alone_in
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.config.trial import Map, MapNetwork, Trial, configurations_of, settings_of, trial_of
from flexsurr.storage import read_all_samples, read_manifest, write_json
from flexsurr.surrogates import Surrogate
from flexsurr.surrogates.coefficient_network import save_coefficient_network
from flexsurr.surrogates.coefficient_polynomial import save_coefficient_polynomial
from flexsurr.training import Fit, ShardedDataset, fit
from flexsurr.training.coefficient_data import coefficient_data
from flexsurr.training.coefficient_fit import fit_coefficients
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.dataset import SampleSource
from flexsurr.training.epochs import Report
from flexsurr.training.saved_surrogate import SavedSurrogate, save_surrogate
from flexsurr.training.sweep import run_id
from flexsurr.training.tracking import read_store, tracked

log = logging.getLogger(__name__)

PROGRESS_EVERY_S = 5.0


def main(job: Job, data: list[Path], store: Path, folder: Path) -> None:
    """Write parameters.json, fit.json, history.parquet, weights.npz and best.npz of the run into `folder`.

    weights.npz holds what the trial keeps, best.npz what validated best. A trial that diverges ends well,
    with status "failed", its reason, and the best weights it met. `data` is the folder of the
    dataset or, for a map, of its samples; a trial that samples configurations has none.
    """
    with alone_in(folder):
        _train(job, data, store, folder)


@dataclass(frozen=True)
class _Task:
    """What one trial is trained on (its hash), how, and how the result is saved."""

    sha256: str
    fit: Callable[[Report], Fit]
    save: Callable[[Any, Path], None]


def _of_field(job: Job, trial: Trial, data: list[Path], folder: Path) -> _Task:
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

    return _Task(dataset.sha256, lambda report: fit(trial, dataset, folder, report), save)


def _of_map(job: Job, trial: Map, data: list[Path], folder: Path) -> _Task:
    shards = [data[0] / f"shard-{number:04d}.parquet" for number in range(job["shards"])]
    samples = read_all_samples(shards, job["configuration"], job["samples"])
    dataset = coefficient_data(samples, job["held_out"], job["seed"])
    save = save_coefficient_network if isinstance(trial, MapNetwork) else save_coefficient_polynomial
    return _Task(dataset.sha256, lambda report: fit_coefficients(trial, dataset, folder, report), save)


def _train(job: Job, data: list[Path], store: Path, folder: Path) -> None:
    trial = trial_of(**job["trial"])
    task = (
        _of_map(job, trial, data, folder) if isinstance(trial, Map) else _of_field(job, trial, data, folder)
    )
    described = {**job, "dataset_sha256": task.sha256}
    write_json(folder / "parameters.json", described)
    page_store = read_store(store)
    shown = {"variant": job["variant"], **job["trial"], "dataset_sha256": task.sha256}
    with tracked(page_store, job["study"], job["run_id"], shown) as page:
        next_s = time.monotonic()

        def report(epoch: int, train_loss: float, validation_loss: float, wall_s: float) -> None:
            nonlocal next_s
            page.epoch(epoch, train_loss, validation_loss)
            if time.monotonic() >= next_s:
                log.info(
                    "epoch %d, %.1f s: training %.3e, validation %.3e",
                    epoch,
                    wall_s,
                    train_loss,
                    validation_loss,
                )
                next_s = time.monotonic() + PROGRESS_EVERY_S

        result = task.fit(report)
        figures = _figures(job, trial, result, task.sha256)
        page.status, page.reason = result.status, result.reason
        task.save(result.surrogate, folder / "weights.npz")
        task.save(result.best, folder / "best.npz")
        write_frame(folder / "history.parquet", result.history)
        write_json(folder / "fit.json", figures)
        files = [folder / name for name in ("parameters.json", "weights.npz", "history.parquet")]
        page.keep(figures, {"dataset_sha256": task.sha256}, files)
    log.info(
        "%s after %d epochs, %.1f s%s", result.status, result.epochs, result.wall_s, _because(result.reason)
    )


def _basis(job: Job) -> ModalBasis | None:
    """The modes of the study's structure; None where its data are the user's own."""
    if "structure" not in job:
        return None
    return reduce(Structure.model_validate(job["structure"]), part_of(Study, job["part"]).reduction)


def _figures(job: Job, trial: Trial, result: Fit, dataset_sha256: str) -> dict[str, Any]:
    settings = settings_of(trial)
    return {
        "run_id": job["run_id"],
        "study": job["study"],
        "variant": job["variant"],
        # the same for all seeds, by which runs are gathered
        "configuration": run_id(trial, job["study"], job["variant"], job["data"], any_seed=True),
        "dataset": job["dataset"],
        "status": result.status,
        "reason": result.reason,
        **settings,
        "hidden": "x".join(str(width) for width in settings["hidden"] or ()),
        "options": ", ".join(f"{name}={value}" for name, value in (settings.get("options") or {}).items())
        or None,
        "epoch_limit": settings["epochs"],
        "epochs": result.epochs,
        "best_epoch": result.best_epoch,
        "wall_s": result.wall_s,
        "processor_s": result.processor_s,
        "parameters": result.parameters,
        "final_loss": _finite(result.final_loss),
        "train_nmse": _finite(result.train_nmse),
        "validation_nmse": _finite(result.validation_nmse),
        "best_validation_nmse": _finite(result.best_validation_nmse),
        "dataset_sha256": dataset_sha256,
    } | _of_its_kind(trial, result)


def _of_its_kind(trial: Trial, result: Fit) -> dict[str, Any]:
    """What else is said of a map: what tables call it, and R² of its worst output on held-out samples."""
    if not isinstance(trial, Map):
        return {}
    worst = 1.0 - max(result.validation_nmse_per_state)
    return {"label": trial.label, "validation_r2_worst": _finite(worst)}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _because(reason: str) -> str:
    return f": {reason}" if reason else ""


if __name__ == "__main__":
    command(
        main,
        {
            "data": "the folder of the dataset, or of samples; none for configurations …",
            "store": "the address of the tracking store",
            "folder": "of the run",
        },
        expected=(EquilibriumNotFound,),
    )
