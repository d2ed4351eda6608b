"""One trial trained, tracked, and written to the folder of its run."""

import logging
import math
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexsurr.beam import EquilibriumNotFound, ModalBasis, reduce
from flexsurr.cli.command import Job, for_rules
from flexsurr.config.schema import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.config.trial import Iterative, Map, Trial, configurations_of, settings_of, trial_of
from flexsurr.storage import read_all_samples, read_manifest, write_json
from flexsurr.storage.files import locked
from flexsurr.storage.frames import write_frame
from flexsurr.surrogates import Surrogate, save_map
from flexsurr.tracking.store import read_store
from flexsurr.tracking.trial import tracked
from flexsurr.training import Fit, ShardedDataset, fit
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.dataset import SampleSource
from flexsurr.training.epochs import Report
from flexsurr.training.saved_surrogate import SavedSurrogate, save_surrogate
from flexsurr.training.sweep import run_id

log = logging.getLogger(__name__)

PROGRESS_EVERY_S = 5.0
GIT_PATIENCE_S = 5.0

RUN = {"store": "the address of the tracking store", "folder": "of the run"}
"""What both commands that train are given beside their data."""


@dataclass(frozen=True)
class Task:
    """What one trial is trained on (its hash), how, and how the result is saved."""

    sha256: str
    fit: Callable[[Report], Fit]
    save: Callable[[Any, Path], None]


@for_rules(EquilibriumNotFound, data="the folder of the dataset; none for configurations", **RUN)
def train(job: Job, data: list[Path], store: Path, folder: Path) -> None:
    """Train one surrogate of a field: a trial of a sweep on one dataset.

    The dataset is in the folder `data`; a trial that samples configurations has none.
    """
    trial = trial_of(**job["trial"])
    _locked_run(job, trial, lambda: _field_task(job, trial, data, folder), store, folder)


def _field_task(job: Job, trial: Trial, data: list[Path], folder: Path) -> Task:
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


@for_rules(data="the folder of the samples", **RUN)
def train_map(job: Job, data: list[Path], store: Path, folder: Path) -> None:
    """Train one surrogate of a map: a trial of a sweep on samples.

    The samples are in the folder `data`.
    """
    trial = trial_of(**job["trial"])
    assert isinstance(trial, Map)  # a study of samples has no others
    _locked_run(job, trial, lambda: _map_task(job, trial, data[0], folder), store, folder)


def _map_task(job: Job, trial: Map, data: Path, folder: Path) -> Task:
    # here, for it takes a second that no field needs
    from flexsurr.training import fit_map
    from flexsurr.training.map_data import map_data

    shards = [data / f"shard-{number:04d}.parquet" for number in range(job["shards"])]
    samples = read_all_samples(shards, job["configuration"], job["samples"])
    dataset = map_data(samples, job["held_out"], job["seed"])
    return Task(dataset.sha256, lambda report: fit_map(trial, dataset, folder, report), save_map)


def _locked_run(job: Job, trial: Trial, task: Callable[[], Task], store: Path, folder: Path) -> None:
    """Write parameters.json, fit.json, history.parquet, weights.npz and best.npz of the run into `folder`.

    weights.npz holds what the trial keeps, best.npz what validated best. A trial that diverges ends well,
    with status "failed", its reason, and the best weights it met; so does one that is given up: "stopped".
    """
    with locked(folder):
        _run(job, trial, task(), store, folder)


def _run(job: Job, trial: Trial, task: Task, store: Path, folder: Path) -> None:
    described = {**job, "dataset_sha256": task.sha256, "commit": commit()}
    write_json(folder / "parameters.json", described)
    with tracked(read_store(store), described, folder) as page:
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
        page.status, page.reason = result.status, result.reason
        task.save(result.surrogate, folder / "weights.npz")
        task.save(result.best, folder / "best.npz")
        write_frame(folder / "history.parquet", result.history)
        write_json(folder / "fit.json", _figures(job, trial, result, task.sha256))
        page.keep()
    log.info(
        "%s after %d epochs, %.1f s%s", result.status, result.epochs, result.wall_s, _because(result.reason)
    )


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
        "give_up": _give_up(trial),
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


def _give_up(trial: Trial) -> str | None:
    """When the trial is to give up, if ever, as tables say it."""
    by = trial.give_up if isinstance(trial, Iterative) else None
    return None if by is None else str(by)


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


def commit() -> str | None:
    """The hash of the commit that the current folder has checked out; None where there is none, or no git.

    "+" follows where a file that git knows differs from it.
    """
    found = _git("rev-parse", "--verify", "HEAD")
    changed = found and _git("status", "--porcelain", "--untracked-files=no")
    return f"{found}+" if changed else found


def _git(*words: str) -> str | None:
    """What git says; None where it fails, or is not there."""
    try:
        asked = subprocess.run(["git", *words], capture_output=True, text=True, timeout=GIT_PATIENCE_S)
    except (OSError, subprocess.SubprocessError):
        return None
    return asked.stdout.strip() if asked.returncode == 0 else None
