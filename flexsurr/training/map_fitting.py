"""Learned maps fitted to samples: polynomials by least squares, networks from random weights to the best.

`fit_map` takes a trial of a sweep, as `fitting.fit` does for fields; `fit_polynomial_map` and
`fit_network_map` fit one map and nothing else.
"""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from flexsurr.aerodynamics.features import OUTPUT_GROUPS, SECOND_ORDER
from flexsurr.config.trial import Iterative, Map, MapNetwork, MapPolynomial
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import Intervals, LearnedMap, NetworkMap, PolynomialMap
from flexsurr.surrogates.monomials import evaluate_monomials, monomials_to_degree
from flexsurr.surrogates.network_map import side_by_side, with_products
from flexsurr.training.epochs import Ending, Fit, Limits, Progress, Report, run_epochs, train
from flexsurr.training.initialisation import initial_weights
from flexsurr.training.least_squares import Triangle
from flexsurr.training.levenberg_marquardt import LevenbergMarquardt, second_order
from flexsurr.training.losses import nmse, spreads
from flexsurr.training.map_data import MapData, nmse_per_output
from flexsurr.training.one_hidden_layer import OneHiddenLayer

DEGREES = {"linear": 1, "quadratic": 2}
BLOCK = 4096  # samples at a time


def coordinates(eta: Array) -> Intervals:
    """Modal coordinates `eta` (samples, r), each between plus and minus its largest size.

    Raises ValueError where one is zero throughout.
    """
    reach = np.max(np.abs(eta), axis=0)
    if not np.all(reach > 0.0):
        raise ValueError(f"coordinate {int(np.argmin(reach)) + 1} is zero in every sample")
    return Intervals(tuple(f"eta_{k + 1}" for k in range(reach.size)), -reach, reach)


def fit_polynomial_map(
    inputs: Intervals, u: Array, y: Array, output_names: Sequence[str], degree: int, even: bool = False
) -> PolynomialMap:
    """Polynomial of total degree ≤ `degree` by least squares; `u` (samples, n), `y` (samples, k).

    `even`: of even powers alone, which is what forces on a symmetric structure have.
    """
    n = len(inputs.names)
    exponents = np.concatenate([np.zeros((1, n), dtype=np.int64), monomials_to_degree(n, degree)])
    if even:
        exponents = exponents[exponents.sum(axis=1) % 2 == 0]
    triangle = Triangle(len(exponents), y.shape[1])
    for first in range(0, len(u), BLOCK):
        part = slice(first, first + BLOCK)
        triangle.add(np.hstack([evaluate_monomials(exponents, inputs.scaled(u[part])), y[part]]))
    coefficients = triangle.solve().reshape(len(exponents), -1)
    return PolynomialMap(inputs, tuple(output_names), exponents, coefficients)


def fit_network_map(
    inputs: Intervals,
    u: Array,
    y: Array,
    output_names: Sequence[str],
    hidden: int,
    activation: str,
    epochs: int,
    seed: int = 0,
) -> NetworkMap:
    """Network of one hidden layer by Levenberg–Marquardt; `u` (samples, n), `y` (samples, k).

    Every output counts relative to its spread; one that does not vary is a constant.
    """
    mean = np.mean(y, axis=0)
    half, constant = spreads(y)
    outputs = Intervals(tuple(output_names), mean - half, mean + half)
    n, k = len(inputs.names), len(outputs.names)
    weights = np.full(k, 1.0 / k)
    objective = OneHiddenLayer.of_map(inputs.scaled(u), outputs.scaled(y), hidden, activation, weights)
    start = initial_weights(n, hidden, k, seed, spread=1.0)
    progress, _ = run_epochs(LevenbergMarquardt(objective, start), objective, start, Limits(epochs))
    network = NetworkMap(inputs, outputs, hidden, activation, progress.best_parameters)
    *_, readout, constants = network.layers()
    readout[:, constant] = 0.0
    constants[constant] = 0.0
    return network


def fit_map(trial: Map, data: MapData, folder: str | Path, report: Report | None = None) -> Fit:
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
        side_by_side(networks, data.outputs.names) if len(networks) > 1 else networks[0]
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


def _polynomial(trial: MapPolynomial, data: MapData, report: Report | None) -> Fit:
    start, processor_start = time.perf_counter(), time.process_time()
    kept = data.held_out
    degree = DEGREES[trial.architecture]
    fitted = fit_polynomial_map(data.inputs, data.u[~kept], data.y[~kept], data.outputs.names, degree)
    spent_s, processor_s = time.perf_counter() - start, time.process_time() - processor_start
    training, validation = (nmse(fitted(data.u[chosen]), data.y[chosen]) for chosen in (~kept, kept))
    coefficients = fitted.coefficients.ravel()
    progress = Progress.at_once(spent_s, (training, validation), coefficients, processor_s, report)
    history = progress.history().assign(outputs="all")
    return _summary(data, fitted, fitted, ending=Ending(), **progress.figures() | {"history": history})


def _summary(data: MapData, kept: LearnedMap, best: LearnedMap, *, ending: Ending, **figures: Any) -> Fit:
    errors = [
        nmse_per_output(learned(data.u[chosen]), data.y[chosen])
        for learned, chosen in ((kept, ~data.held_out), (kept, data.held_out), (best, data.held_out))
    ]
    return Fit(
        surrogate=kept,
        best=best,
        status=ending.status,
        reason=ending.reason,
        train_nmse=float(errors[0].mean()),
        validation_nmse=float(errors[1].mean()),
        best_validation_nmse=float(errors[2].mean()),
        parameters=kept.parameter_count,
        validation_nmse_per_state=tuple(errors[1].tolist()),
        **figures,
    )


@dataclass(frozen=True, eq=False)
class _Fitted:
    """A network of some of the outputs: what is kept, what validated best, how it came about."""

    kept: NetworkMap
    best: NetworkMap
    progress: Progress
    ending: Ending


def _fit_one(trial: MapNetwork, data: MapData, folder: Path, report: Report | None) -> _Fitted:
    """One network of all outputs of `data`."""
    assert isinstance(trial, Iterative)
    (hidden,) = trial.hidden
    products = SECOND_ORDER if trial.inputs == "second_order" else ()
    x, y = with_products(data.scaled_u, products), data.scaled_y
    training, validation = (
        OneHiddenLayer.of_map(x[chosen], y[chosen], hidden, trial.activation)
        for chosen in (~data.held_out, data.held_out)
    )
    # the sums of the hidden weights have unit variance
    start = initial_weights(x.shape[1], hidden, y.shape[1], trial.seed, spread=1.0 / math.sqrt(x.shape[1]))
    optimiser = second_order(trial.optimiser, training, start)
    belongs_to = {"dataset": data.sha256, "outputs": data.outputs.names}
    trained = train(trial, optimiser, validation, start, folder, belongs_to, report)
    best = NetworkMap(data.inputs, data.outputs, hidden, trial.activation, trained.best, products)
    return _Fitted(replace(best, parameters=trained.kept), best, trained.progress, trained.ending)


def _fit_groups(trial: MapNetwork, data: MapData, folder: Path, report: Report | None) -> dict[str, _Fitted]:
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
