"""Fit one model of the airliner's coefficients: a network, or a baseline by least squares."""

import logging
import math
import time
from pathlib import Path
from typing import Any

from flexsurr.cli.alone import alone_in
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.config.trial import Map, MapNetwork, settings_of, trial_of
from flexsurr.simulation.rhs import Array
from flexsurr.storage import read_all_samples, write_json
from flexsurr.surrogates.coefficient_network import save_coefficient_network
from flexsurr.training.coefficient_accuracy import accuracy, held_out_errors
from flexsurr.training.coefficient_baselines import fit_coefficient_polynomial
from flexsurr.training.coefficient_data import CoefficientData, coefficient_data
from flexsurr.training.coefficient_fit import fit_coefficients
from flexsurr.training.tracking import Trial as PageTrial
from flexsurr.training.tracking import read_store, tracked

log = logging.getLogger(__name__)

PROGRESS_EVERY_S = 5.0
DEGREES = {"linear": 1, "quadratic": 2}


def main(job: Job, shards: list[Path], store: Path, folder: Path) -> None:
    """Write parameters.json, metrics.json, accuracy.parquet and errors.parquet of the run into `folder`.

    A network also leaves weights.npz and history.parquet.
    """
    with alone_in(folder):
        _train(job, shards, store, folder)


def _train(job: Job, shards: list[Path], store: Path, folder: Path) -> None:
    trial = trial_of(**job["trial"])
    assert isinstance(trial, Map)
    samples = read_all_samples(shards, job["configuration"], job["samples"])
    data = coefficient_data(samples, job["held_out"], job["seed"])
    write_json(folder / "parameters.json", {**job, "dataset_sha256": data.sha256})
    with tracked(read_store(store), job["study"], job["run_id"], job["trial"]) as page:
        if isinstance(trial, MapNetwork):
            predicted, figures = _network(trial, data, folder, page)
        else:
            start = time.perf_counter()
            predicted = fit_coefficient_polynomial(data, DEGREES[trial.architecture])(data.u)
            figures = {"status": "finished", "reason": "", "wall_s": time.perf_counter() - start}
        table = accuracy(data, predicted, trial.label)
        write_frame(folder / "accuracy.parquet", table)
        write_frame(folder / "errors.parquet", held_out_errors(data, predicted))
        metrics = {
            "run_id": job["run_id"],
            "study": job["study"],
            "label": trial.label,
            **settings_of(trial),
            **figures,
            "train_nmse": float(table["train_nmse"].mean()),
            "validation_nmse": float(table["validation_nmse"].mean()),
            "validation_r2_worst": float(table["validation_r2"].min()),
            "dataset_sha256": data.sha256,
        }
        metrics = {name: _finite(value) for name, value in metrics.items()}
        page.status, page.reason = str(metrics["status"]), str(metrics["reason"])
        write_json(folder / "metrics.json", metrics)
        page.keep(metrics, {"dataset_sha256": data.sha256}, [folder / "metrics.json"])
    log.info("%s: worst validation R² %.6f", job["run_id"], metrics["validation_r2_worst"] or math.nan)


def _network(
    trial: MapNetwork, data: CoefficientData, folder: Path, page: PageTrial
) -> tuple[Array, dict[str, Any]]:
    next_s = time.monotonic()

    def report(epoch: int, train_loss: float, validation_loss: float, wall_s: float) -> None:
        nonlocal next_s
        page.epoch(epoch, train_loss, validation_loss)
        if time.monotonic() >= next_s:
            losses = (epoch, wall_s, train_loss, validation_loss)
            log.info("epoch %d, %.1f s: training %.3e, validation %.3e", *losses)
            next_s = time.monotonic() + PROGRESS_EVERY_S

    result = fit_coefficients(trial, data, folder, report)
    save_coefficient_network(result.network, folder / "weights.npz")
    write_frame(folder / "history.parquet", result.history)
    figures = {
        "status": result.status,
        "reason": result.reason,
        "epochs_done": result.epochs,
        "best_epoch": result.best_epoch,
        "wall_s": result.wall_s,
        "parameters": result.network.parameters.size,
    }
    return result.network(data.u), figures


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


if __name__ == "__main__":
    command(
        main,
        {
            "shards": "all of the samples …",
            "store": "the address of the tracking store",
            "folder": "of the run",
        },
    )
