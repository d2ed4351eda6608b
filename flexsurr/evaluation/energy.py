"""Energy: how far a free response strays from the energy it started with."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from flexsurr.beam import ModalBasis, reduced_order
from flexsurr.config.study import Integrator, Study, Variant
from flexsurr.evaluation.cases import DRAWN_EVERY_S, Case, evaluation_cases, sample_times
from flexsurr.evaluation.contenders import Contender, contenders
from flexsurr.simulation import simulate
from flexsurr.simulation.rhs import Array

NOT_DRIFTING = Integrator(method="gauss_legendre_6", step_s=DRAWN_EVERY_S)
"""Symplectic, order 6: its own drift lies far below that of any network (Fig. 13)."""

SCIPY_DEFAULTS: tuple[Integrator, ...] = tuple(
    Integrator(method=method) for method in ("scipy_radau", "scipy_rk45", "scipy_dop853", "scipy_lsoda")
)

ENERGY_COLUMNS = ("panel", "variant", "model", "integrator", "t_s", "energy_J", "drift_percent")


def relative_drift_percent(energy: Array) -> Array:
    """|H(t) − H(0)|/|H(0)| in percent, (k,), of `energy` (k,) [J]."""
    return np.asarray(100.0 * np.abs(energy - energy[0]) / np.abs(energy[0]))


def drift_percent(energy: Array, t: Array, free_from_s: float = 0.0) -> float:
    """The largest relative drift [%] from the first sample at which no load acts any more.

    NaN where no two samples lie after `free_from_s` [s]: there is nothing to compare.
    """
    free = energy[t[: energy.size] >= free_from_s]
    return float(relative_drift_percent(free).max()) if free.size > 1 else float("nan")


def energy_table(
    study: Study, basis: ModalBasis, variant: Variant, surrogates: Mapping[str, Any]
) -> pd.DataFrame:
    """Energy against time in the first free response of the study (Fig. 13); columns `ENERGY_COLUMNS`.

    Panel "models": the reference and each surrogate with an integrator that does not drift. Panel
    "integrators": the exact field with each integrator of the study and SciPy's at their defaults.
    The energy is the reference's exact Hamiltonian along the trajectory [J], whatever the model: the
    only one that is the same quantity for all. A trajectory that ends early ends its rows.
    """
    case = evaluation_cases(basis, study, "free")[0]
    compiled = [c for c in contenders(basis, variant, surrogates) if c.implementation == "compiled"]
    exact = [c for c in compiled if c.model == "rom"]
    integrators = (*study.evaluation.integrators, *SCIPY_DEFAULTS)
    settings = study.evaluation
    fine = sample_times(settings.duration_s, min(settings.output_step_s, DRAWN_EVERY_S))
    # a fixed step divides the time between samples, so integrators are judged at the study's own
    coarse = sample_times(settings.duration_s, settings.output_step_s)
    models = [_energy(basis, variant, case, contender, NOT_DRIFTING, fine) for contender in compiled]
    drifts = [_energy(basis, variant, case, exact[0], integrator, coarse) for integrator in integrators]
    panels = {"models": pd.concat(models), "integrators": pd.concat(drifts)}
    table = pd.concat([frame.assign(panel=panel) for panel, frame in panels.items()], ignore_index=True)
    return table[list(ENERGY_COLUMNS)]


def _energy(
    basis: ModalBasis, variant: Variant, case: Case, contender: Contender, integrator: Integrator, t: Array
) -> pd.DataFrame:
    trajectory = simulate(contender.under(basis, case), t, case.x0, integrator)
    energy = reduced_order(basis, variant, "numpy").energy(trajectory.x)
    return pd.DataFrame(
        {
            "variant": variant,
            "model": contender.model,
            "integrator": integrator.label,
            "t_s": trajectory.t,
            "energy_J": energy,
            "drift_percent": relative_drift_percent(energy),
        }
    )
