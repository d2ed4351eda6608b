"""One trial of a map on samples: by least squares, or from random weights to the best ones."""

import math
import time
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.linalg import lstsq

from flexsurr.aerodynamics.features import OUTPUT_GROUPS, SECOND_ORDER
from flexsurr.config.trial import Iterative, Map, MapNetwork, MapPolynomial
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.coefficient_network import (
    CoefficientNetwork,
    shapes_of,
    side_by_side,
    with_products,
)
from flexsurr.surrogates.coefficient_polynomial import CoefficientPolynomial, terms
from flexsurr.training.coefficient_data import CoefficientData
from flexsurr.training.epochs import Ending, Limits, Report, run_epochs
from flexsurr.training.fit_result import Fit
from flexsurr.training.levenberg_marquardt import LevenbergMarquardt
from flexsurr.training.losses import nmse
from flexsurr.training.optimiser import Optimiser
from flexsurr.training.progress import Progress
from flexsurr.training.structured_normal_equations import CoefficientObjective

DEGREES = {"linear": 1, "quadratic": 2}


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


@dataclass(frozen=True, eq=False)
class _Fitted:
    """A network of some of the outputs: what is kept, what validated best, how it came about."""

    kept: CoefficientNetwork
    best: CoefficientNetwork
    progress: Progress
    ending: Ending


def fit_coefficients(
    trial: Map, data: CoefficientData, folder: str | Path, report: Report | None = None
) -> Fit:
    """Fit a map to `data`, resuming from the checkpoints in `folder`: `fitting.fit` for trials of maps.

    Polynomials are a linear least-squares solution. Four networks are fitted one after the other and stand
    side by side: `epochs` and `best_epoch` are the latest of theirs, times their sums; epochs are reported
    counted on. The history has a column more, `outputs`: the name of the group, or "all".
    """
    if isinstance(trial, MapPolynomial):
        return _polynomial(trial, data, report)
    assert isinstance(trial, MapNetwork)
    if trial.networks == "one":
        fits = {"all": _fit_one(trial, data, Path(folder), report)}
    else:
        fits = _fit_groups(trial, data, Path(folder), report)
    kept, best = (
        side_by_side(networks, data.output_names) if len(networks) > 1 else networks[0]
        for networks in ([fit.kept for fit in fits.values()], [fit.best for fit in fits.values()])
    )
    outputs = [len(fit.kept.output_names) for fit in fits.values()]
    every = [fit.progress for fit in fits.values()]
    return _summary(
        data,
        kept,
        best,
        ending=Ending.of_all({name: fit.ending for name, fit in fits.items()}),
        epochs=max(progress.epoch for progress in every),
        best_epoch=max(progress.best_epoch for progress in every),
        wall_s=sum(progress.wall_s for progress in every),
        processor_s=sum(progress.processor_s for progress in every),
        final_loss=float(np.average([progress.final_loss for progress in every], weights=outputs)),
        history=pd.concat(
            [fit.progress.history().assign(outputs=name) for name, fit in fits.items()], ignore_index=True
        ),
    )


def fit_coefficient_polynomial(data: CoefficientData, degree: int) -> CoefficientPolynomial:
    """The polynomial with the least squared errors over the training samples."""
    x, y = data.scaled_u[~data.held_out], data.y[~data.held_out]
    weights, *_ = lstsq(terms(x, degree), y)
    return CoefficientPolynomial(degree, weights, data.input_low, data.input_high)


def _polynomial(trial: MapPolynomial, data: CoefficientData, report: Report | None) -> Fit:
    start, processor_start = time.perf_counter(), time.process_time()
    fitted = fit_coefficient_polynomial(data, DEGREES[trial.architecture])
    spent_s, processor_s = time.perf_counter() - start, time.process_time() - processor_start
    kept = data.held_out
    losses = [nmse(fitted(data.u[chosen]), data.y[chosen]) for chosen in (~kept, kept)]
    progress = Progress(math.inf, fitted.parameters)
    progress.add(spent_s, losses[0], losses[1], fitted.parameters, processor_s)
    if report is not None:
        report(1, losses[0], losses[1], spent_s)
    return _summary(
        data,
        fitted,
        fitted,
        ending=Ending(),
        epochs=1,
        best_epoch=1,
        wall_s=spent_s,
        processor_s=processor_s,
        final_loss=losses[0],
        history=progress.history().assign(outputs="all"),
    )


def _summary(data: CoefficientData, kept: Any, best: Any, *, ending: Ending, **figures: Any) -> Fit:
    held_out = data.held_out
    errors = [
        np.mean((network(data.u[chosen]) - data.y[chosen]) ** 2, axis=0) / np.var(data.y[chosen], axis=0)
        for network, chosen in ((kept, ~held_out), (kept, held_out), (best, held_out))
    ]
    return Fit(
        surrogate=kept,
        best=best,
        status=ending.status,
        reason=ending.reason,
        train_nmse=float(errors[0].mean()),
        validation_nmse=float(errors[1].mean()),
        best_validation_nmse=float(errors[2].mean()),
        parameters=kept.parameters.size,
        validation_nmse_per_state=tuple(errors[1].tolist()),
        **figures,
    )


def _fit_one(trial: MapNetwork, data: CoefficientData, folder: Path, report: Report | None) -> _Fitted:
    """One network of all outputs of `data`."""
    assert isinstance(trial, Iterative)
    (hidden,) = trial.hidden
    products = SECOND_ORDER if trial.inputs == "second_order" else ()
    x, y = with_products(data.scaled_u, products), data.scaled_y
    training, validation = (
        CoefficientObjective.of(x[chosen], y[chosen], hidden, trial.activation)
        for chosen in (~data.held_out, data.held_out)
    )
    start = initial_weights(x.shape[1], hidden, y.shape[1], trial.seed)
    optimiser = _optimiser(trial, training, start)
    progress, ending = run_epochs(
        optimiser,
        validation,
        start,
        Limits.of(trial),
        folder,
        {"trial": trial.model_dump(mode="json"), "dataset": data.sha256, "outputs": data.output_names},
        report,
    )
    best = CoefficientNetwork(
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
    last = replace(best, parameters=optimiser.parameters)
    return _Fitted(best if ending.reason or trial.keep == "best" else last, best, progress, ending)


def _fit_groups(
    trial: MapNetwork, data: CoefficientData, folder: Path, report: Report | None
) -> dict[str, _Fitted]:
    """A network for each of OUTPUT_GROUPS."""
    fits: dict[str, _Fitted] = {}
    for name, outputs in OUTPUT_GROUPS.items():
        before = sum(fit.progress.epoch for fit in fits.values())
        counted_on = report and partial(_report_after, report, before)
        fits[name] = _fit_one(trial, data.only(outputs), folder / name, counted_on)
        if (folder / name).is_dir():
            (folder / name).rmdir()
    return fits


def _report_after(
    report: Report, before: int, epoch: int, train_loss: float, validation_loss: float, wall_s: float
) -> None:
    report(before + epoch, train_loss, validation_loss, wall_s)


def _optimiser(trial: Iterative, objective: CoefficientObjective, parameters: Array) -> Optimiser:
    if trial.optimiser == "lbfgs":
        from flexsurr.training.lbfgs import LBFGS  # here, for it imports torch

        return LBFGS(objective, parameters)
    return LevenbergMarquardt(objective, parameters)
