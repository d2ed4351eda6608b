"""One trial on one dataset, from random weights to the best ones, whichever the optimiser."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from flexsurr.config.trial import (
    AdamW,
    EvenNetwork,
    FieldNetwork,
    FieldPolynomial,
    FirstOrder,
    Iterative,
    PortHamiltonianNetwork,
    TorchModule,
    TrainedField,
    Trial,
)
from flexsurr.storage import Scales
from flexsurr.surrogates import (
    HNN,
    MLP,
    DissipativeHNN,
    Network,
    PortHamiltonian,
    StateScaling,
    Surrogate,
    canonical_scaling,
    feature_scaling,
    min_max_scaling,
)
from flexsurr.training.adam import Adam
from flexsurr.training.configuration_samples import ConfigurationSamples
from flexsurr.training.dataset import Dataset, SampleSource
from flexsurr.training.epochs import Ending, Fit, Loss, Optimiser, Progress, Report, train
from flexsurr.training.even_hnn_training import EvenHNNObjective, untrained_even_hnn
from flexsurr.training.initialisation import initial_parameters
from flexsurr.training.inverse_dynamics import (
    NotPositiveDefinite,
    fit_port_hamiltonian,
    indefinite,
    is_positive_definite,
)
from flexsurr.training.least_squares import fit_polynomial
from flexsurr.training.levenberg_marquardt import LevenbergMarquardt, second_order
from flexsurr.training.losses import FieldErrors
from flexsurr.training.objective import Objective
from flexsurr.training.port_hamiltonian_training import (
    EntriesOptimiser,
    FieldLoss,
    InverseThenForward,
    PortHamiltonianObjective,
    untrained_entries,
    untrained_mirrored,
    untrained_port_hamiltonian,
)

NETWORKS: dict[str, type[Network]] = {form.architecture: form for form in (HNN, MLP, DissipativeHNN)}
SCALINGS: dict[str, Callable[[Scales], StateScaling]] = {
    "canonical": canonical_scaling,
    "per_feature": feature_scaling,
    "min_max": min_max_scaling,
}


def fit(trial: Trial, source: SampleSource, folder: str | Path, report: Report | None = None) -> Fit:
    """Fit a surrogate to `source`, resuming from the checkpoint of the same trial and dataset in `folder`.

    Least squares reads the samples block by block; every other optimiser has them all in memory.
    Ends after the trial's epochs, when validation has not improved by 1 % over `patience` of them, after
    `time_limit_s` of processor time, or when the optimiser has nothing left to do, and keeps the weights
    that validated best, or the last ones. `report(epoch, train_loss, validation_loss, wall_s)` is called
    after each epoch. A loss that is not finite ends the fit as failed, and a fit of which no epoch
    validates better than its start has failed too; one that is hopeless by `give_up` is stopped.
    Interrupted and resumed, the weights are those of an uninterrupted run (unless the time limit ends it).
    """
    folder = Path(folder)
    if isinstance(trial, FieldPolynomial):
        return _fit_linear(trial, source, report)
    assert isinstance(trial, Iterative)  # as everything but a polynomial is
    assert isinstance(trial, TrainedField)
    dataset = source.loaded()
    if trial.samples_per_trajectory is not None:
        dataset = dataset.thinned(trial.samples_per_trajectory)
    start, processor_start = time.perf_counter(), time.process_time()
    network, training, validation, optimiser = _begun(trial, dataset)
    trained = train(
        trial,
        optimiser,
        validation,
        network.parameters,
        folder,
        {"dataset": dataset.sha256},
        report,
        prepared=(time.perf_counter() - start, time.process_time() - processor_start),
    )
    best = replace(network, parameters=trained.best)
    network = replace(network, parameters=trained.kept)
    errors = FieldErrors.over(network, dataset.validation_blocks())
    ending = _with_mass(network, trained.ending, dataset)
    return Fit(
        surrogate=network,
        best=best,
        status=ending.status,
        reason=ending.reason,
        train_nmse=training.loss(network.parameters),
        validation_nmse=validation.loss(network.parameters),
        best_validation_nmse=trained.progress.best_loss,
        parameters=network.parameter_count,
        validation_nmse_per_state=tuple(errors.nmse_per_state().tolist()),
        **trained.progress.figures(),
    )


def _with_mass(surrogate: Surrogate, ending: Ending, dataset: Dataset) -> Ending:
    """`ending`, or that of a surrogate whose mass matrix is not positive definite at every sample."""
    if not isinstance(surrogate, PortHamiltonian) or ending.reason:
        return ending
    q = np.concatenate([dataset.x_train, dataset.x_validation])[:, : surrogate.pairs]
    positive = is_positive_definite(surrogate, q)
    if positive.all():
        return ending
    return Ending("failed", indefinite("of the network", q[np.argmin(positive)]))


def _begun(trial: Iterative, dataset: Dataset) -> tuple[Surrogate, Loss, Loss, Optimiser]:
    """Random weights, their losses over training and validation samples, and what will make them better."""
    training = dataset.x_train, dataset.dx_train
    validation = dataset.x_validation, dataset.dx_validation
    if isinstance(trial, PortHamiltonianNetwork):
        what = dataset, trial.hidden, trial.activation, trial.seed, trial.potential == "polynomial"
        if trial.mass_matrix != "factored":
            if trial.mass_matrix == "mirrored":
                assert isinstance(dataset, ConfigurationSamples)  # as configuration has seen to
                entries, mass = untrained_mirrored(dataset, *what[1:])
            else:
                entries, mass = untrained_entries(*what)
            q = training[0][:, : entries.pairs] / entries.scales()[1]
            optimiser = EntriesOptimiser(entries, q, mass, isinstance(dataset, ConfigurationSamples))
            return entries, FieldLoss(entries, *training), FieldLoss(entries, *validation), optimiser
        port = untrained_port_hamiltonian(*what)
        inverse, forward = (PortHamiltonianObjective.of(port, *training, forward=f) for f in (False, True))
        held_out = PortHamiltonianObjective.of(port, *validation, forward=True)
        return port, forward, held_out, InverseThenForward(inverse, forward, port.parameters)
    if isinstance(trial, EvenNetwork):
        even = untrained_even_hnn(dataset, trial.hidden, trial.activation, trial.seed)
        products = EvenHNNObjective.of(even, *training)
        of_validation = EvenHNNObjective.of(even, *validation)
        return even, products, of_validation, LevenbergMarquardt(products, even.parameters)
    if isinstance(trial, TorchModule):
        from flexsurr.training.torch_training import begun  # here, for it imports torch

        return begun(trial, SCALINGS[trial.scaling](dataset.scales), dataset)
    assert isinstance(trial, FieldNetwork)
    network = _untrained(trial, dataset)
    if trial.device != "cpu":
        from flexsurr.training.torch_training import begun_on, device_of  # here, for it imports torch

        device = device_of(trial.device)
        if device.type != "cpu":  # where compiled code is faster
            return begun_on(device, trial, network, dataset)
    objective = Objective.of(network, *training)
    return network, objective, Objective.of(network, *validation), _optimiser(trial, objective)


def _untrained(trial: Iterative, dataset: Dataset) -> Network:
    assert isinstance(trial, FieldNetwork)
    form = NETWORKS[trial.architecture]
    spread: Literal["torch", "wide"] = "torch" if isinstance(trial, FirstOrder) else "wide"
    return form(
        parameters=initial_parameters(form, len(dataset.state_names), trial.hidden, spread, trial.seed),
        scaling=SCALINGS[trial.scaling](dataset.scales),
        state_names=dataset.state_names,
        state_units=dataset.state_units,
        hidden=trial.hidden,
        activation=trial.activation,
    )


def _optimiser(trial: Iterative, objective: Objective) -> Optimiser:
    parameters = objective.network.parameters
    if isinstance(trial, FirstOrder):
        return Adam(
            replace(objective, minimised=trial.loss),
            parameters,
            learning_rate=trial.learning_rate,
            batch_size=trial.batch_size,
            epochs=trial.epochs,
            cosine=trial.optimiser.endswith("cosine"),
            weight_decay=trial.weight_decay if isinstance(trial, AdamW) else 0.0,
            precision=trial.precision,
            seed=trial.seed,
        )
    return second_order(trial.optimiser, objective, parameters)


def _fit_linear(trial: FieldPolynomial, source: SampleSource, report: Report | None) -> Fit:
    start, processor_start = time.perf_counter(), time.process_time()
    reason = ""
    surrogate: Surrogate
    if trial.architecture == "polynomial":
        surrogate = fit_polynomial(source, trial.degree)
    else:
        try:
            surrogate = fit_port_hamiltonian(
                source, trial.degree, trial.potential == "polynomial", trial.terms == "sparse"
            )
        except NotPositiveDefinite as failure:
            surrogate, reason = failure.surrogate, str(failure)
    training = FieldErrors.over(surrogate, source.training_blocks())
    validation = FieldErrors.over(surrogate, source.validation_blocks())
    losses = training.nmse(), validation.nmse()
    spent_s, processor_s = time.perf_counter() - start, time.process_time() - processor_start
    progress = Progress.at_once(spent_s, losses, surrogate.parameters, processor_s, report)
    return Fit(
        surrogate=surrogate,
        best=surrogate,
        status="failed" if reason else "finished",
        reason=reason,
        train_nmse=losses[0],
        validation_nmse=losses[1],
        best_validation_nmse=losses[1],
        parameters=surrogate.parameter_count,
        validation_nmse_per_state=tuple(validation.nmse_per_state().tolist()),
        **progress.figures(),
    )
