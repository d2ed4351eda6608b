"""One trial on the airliner's samples: networks of coefficients, from random weights to the best ones."""

import math
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd

from flexsurr.aerodynamics.features import OUTPUT_GROUPS, SECOND_ORDER
from flexsurr.config.trial import Iterative, MapNetwork
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.coefficient_network import (
    CoefficientNetwork,
    shapes_of,
    side_by_side,
    with_products,
)
from flexsurr.training.coefficient_data import CoefficientData
from flexsurr.training.epochs import Limits, Report, run_epochs
from flexsurr.training.levenberg_marquardt import LevenbergMarquardt
from flexsurr.training.losses import nmse
from flexsurr.training.optimiser import Optimiser
from flexsurr.training.progress import Progress
from flexsurr.training.structured_normal_equations import CoefficientObjective


@dataclass(frozen=True, eq=False)
class CoefficientFit:
    """What a trial came to; losses are the nmse averaged over outputs, weights those that validated best.

    `epochs` and `best_epoch` are the latest of its networks', `wall_s` [s] their sum. `history` has a row an
    epoch: epoch, wall_s, train_loss, validation_loss, processor_s, outputs (the name of the group, or "all").
    """

    network: CoefficientNetwork
    status: Literal["finished", "failed"]
    reason: str
    epochs: int
    best_epoch: int
    wall_s: float
    train_nmse: float
    validation_nmse: float
    history: pd.DataFrame


def initial_weights(inputs: int, hidden: int, outputs: int, seed: int) -> Array:
    """Normal hidden weights whose sums have unit variance, uniform biases; small weights of the outputs."""
    generator = np.random.default_rng(seed)
    shapes = shapes_of(inputs, hidden, outputs)
    pieces = [
        generator.standard_normal(shapes[0]) / math.sqrt(inputs),
        generator.uniform(-1.0, 1.0, shapes[1]),
        generator.uniform(-1.0, 1.0, shapes[2]) / math.sqrt(hidden),
        np.zeros(shapes[3]),
    ]
    return np.concatenate([piece.ravel() for piece in pieces])


def fit_coefficients(
    trial: MapNetwork, data: CoefficientData, folder: str | Path, report: Report | None = None
) -> CoefficientFit:
    """Fit a network, or four side by side, to `data`, resuming from the checkpoints in `folder`.

    Each ends after the trial's epochs, `time_limit_s` of processor time, or when the optimiser has nothing
    left to do, and keeps the weights that validated best. `report(epoch, train_loss, validation_loss,
    wall_s)` is called after each epoch; epochs of several networks are counted on. A loss that is not
    finite ends the fit as failed, and a fit of which no epoch validates better than its start has failed too.
    """
    if trial.networks == "one":
        network, progress, reason = _fit_one(trial, data, Path(folder), report)
        fits, reasons = {"all": progress}, [reason] if reason else []
    else:
        network, fits, reasons = _fit_groups(trial, data, Path(folder), report)
    kept = data.held_out
    return CoefficientFit(
        network=network,
        status="failed" if reasons else "finished",
        reason="; ".join(reasons),
        epochs=max(progress.epoch for progress in fits.values()),
        best_epoch=max(progress.best_epoch for progress in fits.values()),
        wall_s=sum(progress.wall_s for progress in fits.values()),
        train_nmse=nmse(network(data.u[~kept]), data.y[~kept]),
        validation_nmse=nmse(network(data.u[kept]), data.y[kept]),
        history=pd.concat(
            [progress.history().assign(outputs=name) for name, progress in fits.items()], ignore_index=True
        ),
    )


def _fit_one(
    trial: MapNetwork, data: CoefficientData, folder: Path, report: Report | None
) -> tuple[CoefficientNetwork, Progress, str]:
    """One network of all outputs of `data`, how it came about, and why it failed, or ""."""
    assert isinstance(trial, Iterative)
    (hidden,) = trial.hidden
    products = SECOND_ORDER if trial.inputs == "second_order" else ()
    x, y = with_products(data.scaled_u, products), data.scaled_y
    training, validation = (
        CoefficientObjective.of(x[chosen], y[chosen], hidden, trial.activation)
        for chosen in (~data.held_out, data.held_out)
    )
    start = initial_weights(x.shape[1], hidden, y.shape[1], trial.seed)
    progress, reason = run_epochs(
        _optimiser(trial, training, start),
        validation,
        start,
        Limits(trial.epochs, trial.patience, trial.time_limit_s),
        folder,
        {"trial": trial.model_dump(mode="json"), "dataset": data.sha256, "outputs": data.output_names},
        report,
    )
    network = CoefficientNetwork(
        parameters=progress.best_parameters,
        hidden=hidden,
        activation=trial.activation,
        input_low=data.input_low,
        input_high=data.input_high,
        output_low=data.output_low,
        output_high=data.output_high,
        input_names=data.input_names,
        output_names=data.output_names,
        products=products,
    )
    return network, progress, reason


def _fit_groups(
    trial: MapNetwork, data: CoefficientData, folder: Path, report: Report | None
) -> tuple[CoefficientNetwork, dict[str, Progress], list[str]]:
    """A network for each of OUTPUT_GROUPS as one, how each came about, and why those that failed did."""
    networks: list[CoefficientNetwork] = []
    fits: dict[str, Progress] = {}
    reasons: list[str] = []
    for name, outputs in OUTPUT_GROUPS.items():
        before = sum(progress.epoch for progress in fits.values())
        counted_on = report and partial(_report_after, report, before)
        network, fits[name], reason = _fit_one(trial, data.only(outputs), folder / name, counted_on)
        networks.append(network)
        reasons += [f"{name}: {reason}"] if reason else []
        if (folder / name).is_dir():
            (folder / name).rmdir()
    return side_by_side(networks, data.output_names), fits, reasons


def _report_after(
    report: Report, before: int, epoch: int, train_loss: float, validation_loss: float, wall_s: float
) -> None:
    report(before + epoch, train_loss, validation_loss, wall_s)


def _optimiser(trial: Iterative, objective: CoefficientObjective, parameters: Array) -> Optimiser:
    if trial.optimiser == "lbfgs":
        from flexsurr.training.lbfgs import LBFGS  # here, for it imports torch

        return LBFGS(objective, parameters)
    return LevenbergMarquardt(objective, parameters)
