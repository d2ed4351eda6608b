"""One trial on the airliner's samples: a network of coefficients, from random weights to the best ones."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd

from flexsurr.config.coefficient_sweep import CoefficientTrial
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.coefficient_network import CoefficientNetwork, shapes_of
from flexsurr.training.coefficient_data import CoefficientData
from flexsurr.training.epochs import Limits, Report, run_epochs
from flexsurr.training.levenberg_marquardt import LevenbergMarquardt
from flexsurr.training.optimiser import Optimiser
from flexsurr.training.structured_normal_equations import CoefficientObjective


@dataclass(frozen=True, eq=False)
class CoefficientFit:
    """What a trial came to; losses are the nmse averaged over outputs, the weights those of `best_epoch`."""

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
    trial: CoefficientTrial, data: CoefficientData, folder: str | Path, report: Report | None = None
) -> CoefficientFit:
    """Fit a network to `data`, resuming from the checkpoint of the same trial and samples in `folder`.

    Ends after the trial's epochs or `time_limit_s`, or when the optimiser has nothing left to do, and
    keeps the weights that validated best. `report(epoch, train_loss, validation_loss, wall_s)` is called
    after each epoch. A loss that is not finite ends the fit as failed, and a fit of which no epoch
    validates better than its start has failed too.
    """
    folder = Path(folder)
    assert trial.hidden is not None  # a trial of a network has all three
    assert trial.activation is not None
    assert trial.epochs is not None
    x, y = data.scaled_u, data.scaled_y
    training = CoefficientObjective.of(x[~data.held_out], y[~data.held_out], trial.hidden, trial.activation)
    validation = CoefficientObjective.of(x[data.held_out], y[data.held_out], trial.hidden, trial.activation)
    start = initial_weights(x.shape[1], trial.hidden, y.shape[1], trial.seed)
    optimiser = _optimiser(trial, training, start)
    progress, reason = run_epochs(
        optimiser,
        validation,
        start,
        Limits(trial.epochs, time_limit_s=trial.time_limit_s),
        folder,
        {"trial": trial.model_dump(mode="json"), "dataset": data.sha256},
        report,
    )
    best = progress.best_parameters
    return CoefficientFit(
        network=CoefficientNetwork(
            parameters=best,
            hidden=trial.hidden,
            activation=trial.activation,
            input_low=data.input_low,
            input_high=data.input_high,
            output_low=data.output_low,
            output_high=data.output_high,
            input_names=data.input_names,
            output_names=data.output_names,
        ),
        status="failed" if reason else "finished",
        reason=reason,
        epochs=progress.epoch,
        best_epoch=progress.best_epoch,
        wall_s=progress.wall_s,
        train_nmse=training.loss(best),
        validation_nmse=validation.loss(best),
        history=progress.history(),
    )


def _optimiser(trial: CoefficientTrial, objective: CoefficientObjective, parameters: Array) -> Optimiser:
    if trial.optimiser == "lbfgs":
        from flexsurr.training.lbfgs import LBFGS  # here, for it imports torch

        return LBFGS(objective, parameters)
    return LevenbergMarquardt(objective, parameters)
