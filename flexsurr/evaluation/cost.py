"""What a response costs and what it is worth: every model, implementation and integrator."""

import logging
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Any

import pandas as pd

from flexsurr.beam import ModalBasis, reduced_order
from flexsurr.config.study import EvaluationSettings, Integrator, Study, Variant
from flexsurr.evaluation.accuracy import tip_error
from flexsurr.evaluation.candidates import Candidate, candidates
from flexsurr.evaluation.cases import (
    ReferenceSolution,
    Response,
    energy_above_rest,
    evaluation_cases,
    reference_solutions,
    sample_times,
    tip_motion,
)
from flexsurr.evaluation.columns import COST_COLUMNS
from flexsurr.evaluation.energy import drift_percent, energy_error_percent
from flexsurr.evaluation.published import beside
from flexsurr.evaluation.ratios import PAPERS_INTEGRATOR, summary
from flexsurr.evaluation.timing import cores, measuring, wall_time
from flexsurr.simulation import Trajectory, simulate
from flexsurr.simulation.rhs import Array, Model

log = logging.getLogger(__name__)

# SciPy's solvers step in Python, and torch is called from there: a second a simulation at best, half a minute
# with the described model. So many calls are a steady measure by themselves, and the first few have to do.
STEPS_IN_PYTHON = "scipy_"

ENOUGH_S = 0.02
"""A simulation whose repeats have taken so long together is timed; a row is the mean of several."""


@dataclass(frozen=True)
class Setup:
    """One row of the table to be: a model in one implementation, with one integrator."""

    candidate: Candidate
    integrator: Integrator

    def __str__(self) -> str:
        """As the log has it."""
        return " ".join((self.candidate.model, self.candidate.implementation, self.integrator.label))

    def simulations(self, settings: EvaluationSettings, variant: Variant) -> int:
        """How many of the study's simulations this row runs."""
        if self.candidate.implementation == "described":
            return min(settings.described_simulations.of(variant), settings.simulations)
        if self._runs_in_python:
            return min(settings.scipy_simulations, settings.simulations)
        return settings.simulations

    def repeats(self, settings: EvaluationSettings) -> int:
        """How often each simulation is timed."""
        return 1 if self._runs_in_python else settings.repeats

    @property
    def _runs_in_python(self) -> bool:
        return self.candidate.implementation == "torch" or self.integrator.method.startswith(STEPS_IN_PYTHON)


def cost_table(
    study_name: str,
    study: Study,
    basis: ModalBasis,
    variant: Variant,
    response: Response,
    surrogates: Mapping[str, Any],
    learned: Iterable[Candidate] = (),
    recipes: Mapping[str, str] = MappingProxyType({}),
) -> pd.DataFrame:
    """The rows of cost.csv for one variant and response: `measurements`, summarised by `ratios.summary`.

    `surrogates` maps architectures to fitted surrogates; `learned` are those under learned loads
    (`candidates.with_learned_loads`); `recipes` is as in `published.beside`. Run it alone on the machine.
    """
    frame = summary(measurements(study, basis, variant, response, surrogates, learned))
    frame.insert(0, "study", study_name)
    frame.insert(1, "variant", variant)
    frame.insert(2, "response", response)
    frame = beside(frame, basis.structure.name, recipes)
    return frame[[*COST_COLUMNS, *frame.columns.difference(list(COST_COLUMNS), sort=False)]]


def setups(models: Iterable[Candidate], integrators: Iterable[Integrator]) -> Iterator[Setup]:
    """Every model with the paper's integrator; those with a kernel also with each of `integrators`."""
    compiled_too = [integrator for integrator in integrators if integrator != PAPERS_INTEGRATOR]
    for candidate in models:
        yield Setup(candidate, PAPERS_INTEGRATOR)
        if candidate.steppable:
            yield from (Setup(candidate, integrator) for integrator in compiled_too)


def measurements(
    study: Study,
    basis: ModalBasis,
    variant: Variant,
    response: Response,
    surrogates: Mapping[str, Any],
    learned: Iterable[Candidate] = (),
) -> pd.DataFrame:
    """One row per simulation of every model × implementation × integrator.

    Columns: model, implementation, integrator, simulation, wall_s, completed; and over the samples
    that were reached tip_error_percent, tip_error_2s_percent, phase_lag_s, energy_drift_percent (of
    the reference's exact Hamiltonian: `energy.energy_error_percent`) and own_energy_drift_percent (of the
    model's own Hamiltonian, NaN where it has none or where something dissipates), drifts being counted
    from the end of the load on.
    """
    settings = study.evaluation
    t = sample_times(settings.duration_s, settings.output_step_s)
    cases = evaluation_cases(basis, study, response)
    references = list(reference_solutions(basis, variant, cases, t, settings.reference_integrator))
    models = [*candidates(basis, variant, surrogates, with_torch=True), *learned]
    timed = setups(models, settings.integrators)
    return measured_all(timed, settings, basis, variant, references, f"{variant} {response}")


def measured_all(
    setups: Iterable[Setup],
    settings: EvaluationSettings,
    basis: ModalBasis,
    variant: Variant,
    references: Sequence[ReferenceSolution],
    what: str,
) -> pd.DataFrame:
    """The rows of `measurements` for these setups; `what` names them in the log."""
    timed: list[Timed] = []
    with measuring():
        for setup in setups:
            repeats = setup.repeats(settings)
            first_steps(setup, basis, references[0])
            simulated = [
                _timed(setup, basis, reference, repeats)
                for reference in references[: setup.simulations(settings, variant)]
            ]
            timed += simulated
            log.info(
                "%s: %s, %d simulations of %g s at %.3g s each",
                what,
                setup,
                len(simulated),
                settings.duration_s,
                sum(one.wall_s for one in simulated) / len(simulated),
            )
    # All that is timed has been: the other cores may help now.
    with ThreadPoolExecutor(cores()) as pool:
        rows = pd.DataFrame(pool.map(partial(_measured, basis, variant), timed))
    for names, part in rows.groupby(["model", "implementation", "integrator"], sort=False):
        log.info(
            "%s: %s, worst tip error %.3g %%, %d diverged",
            what,
            " ".join(map(str, names)),
            part["tip_error_percent"].max(),
            (~part["completed"]).sum(),
        )
    return rows


@dataclass(frozen=True, eq=False)
class Timed:
    """One simulation that has been timed, and what its errors are measured against."""

    setup: Setup
    reference: ReferenceSolution
    trajectory: Trajectory
    wall_s: float


def _timed(setup: Setup, basis: ModalBasis, reference: ReferenceSolution, repeats: int) -> Timed:
    model = setup.candidate.under(basis, reference.case)
    trajectory, wall_s = wall_time(
        partial(_run, model, reference.t, reference.case.x0, setup.integrator), repeats, ENOUGH_S
    )
    return Timed(setup, reference, trajectory, wall_s)


def _measured(basis: ModalBasis, variant: Variant, timed: Timed) -> dict[str, Any]:
    """The row of one simulation."""
    setup, reference, trajectory = timed.setup, timed.reference, timed.trajectory
    exact = reduced_order(basis, variant, "compiled")
    own = setup.candidate.energy(trajectory.x)
    error = tip_error(reference, tip_motion(exact, trajectory.x))
    free_from_s = reference.case.free_from_s
    return {
        "model": setup.candidate.model,
        "implementation": setup.candidate.implementation,
        "integrator": setup.integrator.label,
        "simulation": reference.case.number,
        "wall_s": timed.wall_s,
        "completed": trajectory.completed,
        "tip_error_percent": error.whole_percent,
        "tip_error_2s_percent": error.short_percent,
        "phase_lag_s": error.phase_lag_s,
        "energy_drift_percent": energy_error_percent(
            basis.structure, reference, energy_above_rest(basis, variant, trajectory.x), free_from_s
        ),
        "own_energy_drift_percent": (
            float("nan")
            if own is None or basis.structure.dissipates
            else drift_percent(own, trajectory.t, free_from_s)
        ),
    }


def first_steps(setup: Setup, basis: ModalBasis, reference: ReferenceSolution) -> None:
    """They load or compile what the timed ones use."""
    model = setup.candidate.under(basis, reference.case)
    _run(model, reference.t[:2], reference.case.x0, setup.integrator)


def _run(model: Model, t: Array, x0: Array, integrator: Integrator) -> Trajectory:
    return simulate(model, t, x0, integrator)
