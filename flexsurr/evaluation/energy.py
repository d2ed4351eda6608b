"""Energy: how far a response strays from the energy it started with, or should have had; its balance.

The balance: work of the load = change of energy + what the dampers took.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy.integrate import cumulative_simpson

from flexsurr.beam import BeamModel, Load, ModalBasis, loaded
from flexsurr.config.structure import Structure
from flexsurr.config.study import Integrator, Study, Variant
from flexsurr.evaluation.candidates import Candidate, candidates
from flexsurr.evaluation.cases import (
    DRAWN_EVERY_S,
    ReferenceSolution,
    Response,
    energy_above_rest,
    evaluation_cases,
    reference_solution,
    sample_times,
)
from flexsurr.simulation import simulate
from flexsurr.simulation.rhs import Array

SCIPY_DEFAULTS: tuple[Integrator, ...] = tuple(
    Integrator(method=method) for method in ("scipy_radau", "scipy_rk45", "scipy_dop853", "scipy_lsoda")
)

RESPONSES: tuple[Response, ...] = ("free", "forced")

ENERGY_COLUMNS = (
    "panel",
    "variant",
    "response",
    "model",
    "integrator",
    "t_s",
    "energy_J",
    "drift_percent",
    "load_end_s",
)


def relative_drift_percent(energy: Array) -> Array:
    """|H(t) − H(0)|/|H(0)| in percent, (k,), of `energy` (k,) [J]."""
    return np.asarray(100.0 * np.abs(energy - energy[0]) / np.abs(energy[0]))


def drift_percent(energy: Array, t: Array, free_from_s: float = 0.0) -> float:
    """The largest relative drift [%] from the first sample at which no load acts any more.

    NaN where no two samples lie after `free_from_s` [s]: there is nothing to compare.
    """
    free = energy[t[: energy.size] >= free_from_s]
    return float(relative_drift_percent(free).max()) if free.size > 1 else float("nan")


def energy_error_percent(
    structure: Structure, reference: ReferenceSolution, energy: Array, free_from_s: float
) -> float:
    """What the tables call energy drift [%], of `energy` (k,) [J] at the reference's first k times.

    Where nothing dissipates, `drift_percent`. Where something does, the energy has to change: then it is the
    largest distance from the reference's energy over that one's largest.
    """
    if not structure.dissipates:
        return drift_percent(energy, reference.t, free_from_s)
    return float(deviation_percent(reference, energy).max())


def deviation_percent(reference: ReferenceSolution, energy: Array) -> Array:
    """|H − H_ref|/max |H_ref| in percent (k,) of `energy` (k,) [J] at the reference's first k times."""
    distance = np.abs(energy - reference.energy[: energy.size])
    return np.asarray(100.0 * distance / np.abs(reference.energy).max())


def energy_table(
    study: Study, basis: ModalBasis, variant: Variant, surrogates: Mapping[str, Any]
) -> pd.DataFrame:
    """Energy against time in the study's first free and forced response (Fig. 13); columns `ENERGY_COLUMNS`.

    Panel "models": the reference and each surrogate with the study's energy_integrator. Panel "integrators",
    of the free response where nothing dissipates, so that energy should stay: the exact field with each
    integrator of the study and SciPy's at their defaults. The energy is the reference's exact one along the
    trajectory [J], above that of rest, whatever the model: the only one that is the same quantity for all.
    drift_percent is relative to the start in a free response where nothing dissipates, `deviation_percent`
    elsewhere. A trajectory that ends early ends its rows.
    """
    settings = study.evaluation
    compiled = [c for c in candidates(basis, variant, surrogates) if c.steppable]
    exact = [c for c in compiled if c.model == "rom"]
    integrators = (*settings.integrators, *SCIPY_DEFAULTS)
    fine = sample_times(settings.duration_s, min(settings.output_step_s, DRAWN_EVERY_S))
    # a fixed step divides the time between samples, so integrators are compared at the study's own
    coarse = sample_times(settings.duration_s, settings.output_step_s)
    frames = []
    for response in RESPONSES:
        case = evaluation_cases(basis, study, response)[0]
        setups = [("models", fine, candidate, settings.energy_integrator) for candidate in compiled]
        if response == "free" and not basis.structure.dissipates:
            setups += [("integrators", coarse, exact[0], integrator) for integrator in integrators]
        references = {
            t.size: reference_solution(basis, variant, case, t, settings.reference_integrator)
            for t in (fine, coarse)
        }
        for panel, t, candidate, integrator in setups:
            frame = _energy(basis, variant, references[t.size], candidate, integrator)
            frames.append(frame.assign(panel=panel, response=response, load_end_s=case.free_from_s))
    return pd.concat(frames, ignore_index=True)[list(ENERGY_COLUMNS)]


def _energy(
    basis: ModalBasis,
    variant: Variant,
    reference: ReferenceSolution,
    candidate: Candidate,
    integrator: Integrator,
) -> pd.DataFrame:
    case = reference.case
    trajectory = simulate(candidate.under(basis, case), reference.t, case.x0, integrator)
    energy = energy_above_rest(basis, variant, trajectory.x)
    conserves = case.load is None and not basis.structure.dissipates
    return pd.DataFrame(
        {
            "variant": variant,
            "model": candidate.model,
            "integrator": integrator.label,
            "t_s": trajectory.t,
            "energy_J": energy,
            "drift_percent": (
                relative_drift_percent(energy) if conserves else deviation_percent(reference, energy)
            ),
        }
    )


@dataclass(frozen=True)
class EnergyBalance:
    """From the first sample on, (k,) [J]: work of the load, change of the energy, energy dissipated."""

    work: Array
    change: Array
    dissipated: Array

    @property
    def residual(self) -> Array:
        """(k,) [J] work − change − dissipated: of the hamiltonian variant zero, but for the steps."""
        return self.work - self.change - self.dissipated


def energy_balance(
    model: BeamModel, basis: ModalBasis, load: Load | None, t: Array, x: Array
) -> EnergyBalance:
    """The balance of a reduced-order `model` along its states x (k, 2r) at times t (k,) [s].

    Powers Q·η̇ and η̇ᵀ C η̇ at the samples are integrated by Simpson's rule, so the samples must be close
    and the load smooth between the first and the last: split the response where the load jumps. A model
    that drops the gyroscopic term has no such balance.
    """
    r = basis.modes.shape[1]
    field = np.array([model.derivative(time, state) for time, state in zip(t, x, strict=True)])
    rates = field[:, :r]
    force = np.zeros_like(rates)
    if load is not None:
        under_load = loaded(model, basis, load, "numpy")
        force = np.array([under_load.derivative(time, state) for time, state in zip(t, x, strict=True)])[
            :, r:
        ]
        force -= field[:, r:]
    energy = model.energy(x)
    taken = np.sum(rates * (rates @ basis.damping), axis=1)
    return EnergyBalance(
        work=_integral(np.sum(force * rates, axis=1), t),
        change=energy - energy[0],
        dissipated=_integral(taken, t),
    )


def _integral(power: Array, t: Array) -> Array:
    return np.asarray(cumulative_simpson(power, x=t, initial=0.0))
