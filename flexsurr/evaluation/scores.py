"""What a run is scored by: its field on held-out samples, and the error of long free responses."""

import math
import statistics
from collections.abc import Iterable
from typing import Any

import numpy as np

from flexsurr.beam import ModalBasis, full_order, reduced_order
from flexsurr.config.study import Study, Variant
from flexsurr.evaluation.accuracy import tip_error
from flexsurr.evaluation.cases import (
    FIRST_SELECTION_CASE,
    ReferenceSolution,
    energy_above_rest,
    free_cases,
    reference_solutions,
    sample_times,
    tip_motion,
)
from flexsurr.evaluation.energy import energy_error_percent
from flexsurr.evaluation.operations import operations
from flexsurr.simulation import CompiledModel, simulate_ensemble
from flexsurr.surrogates import compiled
from flexsurr.training import Dataset
from flexsurr.training.losses import FieldErrors


def held_out_errors(surrogate: Any, dataset: Dataset) -> dict[str, Any]:
    """The nmse of the surrogate's derivatives on the validation trajectories of `dataset`.

    Keys as in a run's metrics: held_out_nmse, the mean over the states of the mean squared error over the
    variance of the target, and held_out_nmse_by_state, the same for each state by its name. One dataset
    for all runs of a study, whatever each was trained on. A figure that has no finite value is None.
    """
    error = FieldErrors.over(surrogate, dataset.validation_blocks()).nmse_per_state()
    by_state: dict[str, float | None] = dict(
        zip(dataset.state_names, map(_finite, error.tolist()), strict=True)
    )
    return {"held_out_nmse": _finite(float(error.mean())), "held_out_nmse_by_state": by_state}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def long_responses(study: Study, basis: ModalBasis, variant: Variant) -> list[ReferenceSolution]:
    """`study.evaluation.long_responses` free responses of the reference from states no training has seen."""
    settings = study.evaluation
    t = sample_times(settings.duration_s, settings.output_step_s)
    cases = free_cases(basis, study, FIRST_SELECTION_CASE, settings.long_responses)
    return list(reference_solutions(basis, variant, cases, t, settings.reference_integrator))


def reference_operations(basis: ModalBasis, variant: Variant) -> dict[str, int | None]:
    """What one right-hand side of the compiled reference models takes: rom_operations and fom_operations."""
    models = {
        "rom": reduced_order(basis, variant, "compiled"),
        "fom": full_order(basis.structure, variant, "compiled"),
    }
    return {
        f"{name}_operations": operations(model, np.zeros(len(model.state_names)))
        for name, model in models.items()
        if isinstance(model, CompiledModel)
    }


def long_response_errors(
    study: Study, basis: ModalBasis, variant: Variant, surrogate: Any, references: Iterable[ReferenceSolution]
) -> dict[str, float | int | None]:
    """Errors of the surrogate's responses from where `references` (of `long_responses`) start.

    Keys as in a run's metrics: long_response_error_percent_worst and _median (largest error of the
    tip's motion over the reference's largest), energy_drift_percent (worst, of the reference's exact
    Hamiltonian along the surrogate's trajectory), diverged, the number of responses that did not reach
    their end, and operations, what one right-hand side takes. A figure that has no finite value is None; a
    diverged response counts as the worst.
    """
    references = list(references)
    exact = reduced_order(basis, variant, "compiled")
    starts = np.array([reference.case.x0 for reference in references])
    model = compiled(surrogate)
    responses = simulate_ensemble(
        model, references[0].t, starts, study.evaluation.judging_integrator, threads=1
    )
    completed = np.flatnonzero(responses.completed)
    reached = responses.kept[completed]
    energies = energy_above_rest(basis, variant, reached)
    errors, drifts = ([math.inf] * (len(references) - len(completed)) for _ in range(2))
    for k, x, energy in zip(completed, reached, energies, strict=True):
        errors.append(tip_error(references[k], tip_motion(exact, x)).whole_percent)
        drifts.append(energy_error_percent(basis.structure, references[k], energy, 0.0))
    return {
        "long_response_error_percent_worst": _finite(max(errors)),
        "long_response_error_percent_median": _finite(statistics.median(errors)),
        "energy_drift_percent": _finite(max(drifts)),
        "diverged": len(references) - len(completed),
        "operations": operations(model, starts[0]),
    }
