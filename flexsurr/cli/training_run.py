"""One trial trained, tracked, and written to its run's folder, whatever it is trained on."""

import logging
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flexsurr.cli.alone import alone_in
from flexsurr.cli.command import Job
from flexsurr.cli.commit import commit
from flexsurr.cli.frames import write_frame
from flexsurr.config.trial import Iterative, Map, Trial, settings_of
from flexsurr.storage import write_json
from flexsurr.tracking.store import read_store
from flexsurr.tracking.trial import tracked
from flexsurr.training import Fit
from flexsurr.training.epochs import Report
from flexsurr.training.sweep import run_id

log = logging.getLogger(__name__)

PROGRESS_EVERY_S = 5.0

FILES = {"store": "the address of the tracking store", "folder": "of the run"}
"""What both commands that train are given beside their data."""


@dataclass(frozen=True)
class Task:
    """What one trial is trained on (its hash), how, and how the result is saved."""

    sha256: str
    fit: Callable[[Report], Fit]
    save: Callable[[Any, Path], None]


def run(job: Job, trial: Trial, task: Callable[[], Task], store: Path, folder: Path) -> None:
    """Write parameters.json, fit.json, history.parquet, weights.npz and best.npz of the run into `folder`.

    weights.npz holds what the trial keeps, best.npz what validated best. A trial that diverges ends well,
    with status "failed", its reason, and the best weights it met; so does one that is given up: "stopped".
    """
    with alone_in(folder):
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
        "give_up": _words(trial),
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


def _words(trial: Trial) -> str | None:
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
