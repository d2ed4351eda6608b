"""What stands for a reduced model of so many modes, and its cost: every run beside the compiled model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from flexsurr.beam import ModalBasis, reduced_order
from flexsurr.config.study import Study, Variant
from flexsurr.evaluation.candidates import Candidate, fastest
from flexsurr.evaluation.cases import evaluation_cases, reference_solutions, sample_times
from flexsurr.evaluation.columns import CROSSOVER_COLUMNS
from flexsurr.evaluation.cost import Setup, first_steps, measured_all
from flexsurr.evaluation.operations import operations
from flexsurr.evaluation.ratios import summary
from flexsurr.evaluation.timing import compile_ahead
from flexsurr.simulation.rhs import Array, CompiledModel
from flexsurr.surrogates import compiled

REFERENCE = "rom"


@dataclass(frozen=True, eq=False)
class Rival:
    """A surrogate by its run, and what tables call it (`name_of`)."""

    run_id: str
    model: str
    surrogate: Any


def name_of(run: Mapping[str, Any]) -> str:
    """What tables call a run, of its metrics: polynomial_4, polynomial_6_sparse, network_64_atan, …"""
    if run.get("degree"):
        family, settings = "polynomial", [run["degree"], run.get("terms")]
    else:
        family, settings = "network", [run.get("hidden"), run.get("activation"), run.get("mass_matrix")]
    usual = (None, "", "all", "entries")
    return "_".join([family, *(str(setting) for setting in settings if setting not in usual)])


def rivals_table(study: Study, basis: ModalBasis, variant: Variant, rivals: Sequence[Rival]) -> pd.DataFrame:
    """The rows of crossover.csv for one number of modes: the compiled reduced model, then the rivals.

    All are stepped by the first of the study's integrators, from the same initial states. Columns as
    `CROSSOVER_COLUMNS`: parameters is the number of those that are not zero, empty for the reduced model;
    wall_s the mean of a response [s]; tip_error_percent the worst, of the reference's peak, over the
    responses that reached their end, and `diverged` counts the others; operations are what one right-hand
    side takes. Run it alone on the machine.
    """
    settings = study.evaluation
    t = sample_times(settings.duration_s, settings.output_step_s)
    cases = evaluation_cases(basis, study, "free")
    references = list(reference_solutions(basis, variant, cases, t, settings.reference_integrator))
    models = [Candidate(REFERENCE, "compiled", reduced_order(basis, variant, "compiled"))]
    models += [
        Candidate(rival.run_id, fastest(rival.surrogate), compiled(rival.surrogate)) for rival in rivals
    ]
    setups = [Setup(model, settings.integrators[0]) for model in models]
    compile_ahead(partial(first_steps, setup, basis, references[0]) for setup in setups)
    modes = study.reduction.modes
    found = summary(measured_all(setups, settings, basis, variant, references, f"{modes} modes"))
    by_run = {rival.run_id: rival for rival in rivals}
    taken = {model.model: _operations(model, references[0].case.x0) for model in models}
    frame = found.assign(
        modes=modes,
        run_id=[key if key in by_run else "" for key in found["model"]],
        parameters=pd.array(
            [_parameters(by_run[key]) if key in by_run else None for key in found["model"]], dtype="Int64"
        ),
        model=[by_run[key].model if key in by_run else key for key in found["model"]],
        wall_s=found["wall_s_mean"],
        operations=pd.array([taken[key] for key in found["model"]], dtype="Int64"),
    )
    return frame[list(CROSSOVER_COLUMNS)]


def _operations(candidate: Candidate, x: Array) -> int | None:
    field = candidate.field
    return operations(field, x) if isinstance(field, CompiledModel) else None


def _parameters(rival: Rival) -> int:
    return int(np.count_nonzero(rival.surrogate.parameters))
