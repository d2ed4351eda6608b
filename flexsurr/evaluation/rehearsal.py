"""First steps of what will be timed: they leave its machine code on the disk.

To compile takes longer than what is measured of compiled code, and does not have to be alone on the machine.
"""

import logging
from collections.abc import Iterable, Mapping
from time import perf_counter
from typing import Any

import pandas as pd

from flexsurr.beam import ModalBasis
from flexsurr.config.study import Study, Variant
from flexsurr.evaluation.candidates import Candidate, candidates
from flexsurr.evaluation.cases import Response, evaluation_cases, reference_solution, sample_times
from flexsurr.evaluation.cost import Setup, first_steps, setups
from flexsurr.simulation.machine_code import CompiledElsewhere, unless_compiled_elsewhere

log = logging.getLogger(__name__)

REHEARSED_COLUMNS = ("response", "model", "implementation", "integrator", "wall_s")


def rehearsed(
    study: Study,
    basis: ModalBasis,
    variant: Variant,
    response: Response,
    surrogates: Mapping[str, Any],
    learned: Iterable[Candidate] = (),
) -> pd.DataFrame:
    """Take the first steps of every row of `cost.measurements` that compiled code steps; arguments as there.

    Columns `REHEARSED_COLUMNS`: wall_s is how long they took [s], compiling or loading. What another process
    compiles meanwhile comes last.
    """
    settings = study.evaluation
    t = sample_times(settings.duration_s, settings.output_step_s)
    case = evaluation_cases(basis, study, response)[0]
    # what rows are judged by is compiled too
    reference = reference_solution(basis, variant, case, t, settings.reference_integrator)
    models = [*candidates(basis, variant, surrogates), *learned]
    waiting = [setup for setup in setups(models, settings.integrators) if setup.candidate.steppable]
    rows: list[tuple[str, str, str, str, float]] = []

    def rehearse(setup: Setup) -> None:
        start = perf_counter()
        first_steps(setup, basis, reference)
        wall_s = perf_counter() - start
        log.info("%s %s: %s, ready in %.1f s", variant, response, setup, wall_s)
        of = setup.candidate
        rows.append((response, of.model, of.implementation, setup.integrator.label, wall_s))

    deferred = []
    for setup in waiting:
        try:
            with unless_compiled_elsewhere():
                rehearse(setup)
        except CompiledElsewhere:
            deferred.append(setup)
    for setup in deferred:
        rehearse(setup)
    return pd.DataFrame(rows, columns=list(REHEARSED_COLUMNS))
