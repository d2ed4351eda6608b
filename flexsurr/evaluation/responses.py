"""Time histories, for figures: the reference beside its surrogates."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from flexsurr.beam import BeamModel, ModalBasis, reduced_order
from flexsurr.config.study import Study, Variant
from flexsurr.evaluation.accuracy import tip_error_percent
from flexsurr.evaluation.candidates import candidates
from flexsurr.evaluation.cases import (
    DRAWN_EVERY_S,
    ReferenceSolution,
    Response,
    evaluation_cases,
    reference_solution,
    sample_times,
    tip_motion,
)
from flexsurr.simulation import simulate
from flexsurr.simulation.rhs import Array

RESPONSE_COLUMNS = (
    "variant",
    "response",
    "model",
    "t_s",
    "tip_x_m",
    "tip_y_m",
    "tip_z_m",
    "tip_twist_rad",
    "tip_error_percent",
    "load_end_s",
)


def response_table(
    study: Study, basis: ModalBasis, variant: Variant, response: Response, surrogates: Mapping[str, Any]
) -> pd.DataFrame:
    """The first simulation of `response`: model "reference" and each surrogate (Figs. 10, 12, 14, 15).

    Columns `RESPONSE_COLUMNS`: tip position in the clamp's frame [m], twist of the tip, its error in percent
    of the reference's largest displacement, and the time [s] at which the load ends (0 where free). A
    trajectory that ends early ends its rows.
    """
    settings = study.evaluation
    case = evaluation_cases(basis, study, response)[0]
    t = sample_times(settings.duration_s, min(settings.output_step_s, DRAWN_EVERY_S))
    reference = reference_solution(basis, variant, case, t, settings.reference_integrator)
    exact = reduced_order(basis, variant, "compiled")
    states = {"reference": reference.x}
    for candidate in candidates(basis, variant, surrogates):
        if candidate.steppable and candidate.model != "rom":
            model = candidate.under(basis, case)
            states[candidate.model] = simulate(model, t, case.x0, settings.drawing_integrator).x
    frames = [_frame(variant, response, model, reference, exact, x) for model, x in states.items()]
    return pd.concat(frames, ignore_index=True)


def _frame(
    variant: str, response: str, model: str, reference: ReferenceSolution, exact: BeamModel, x: Array
) -> pd.DataFrame:
    tip = exact.tip(x)
    return pd.DataFrame(
        {
            "variant": variant,
            "response": response,
            "model": model,
            "t_s": reference.t[: tip.shape[0]],
            "tip_x_m": tip[:, 0],
            "tip_y_m": tip[:, 1],
            "tip_z_m": tip[:, 2],
            "tip_twist_rad": np.unwrap(exact.twist(x)),
            "tip_error_percent": tip_error_percent(reference, tip_motion(exact, x)),
            "load_end_s": reference.case.free_from_s,
        },
        columns=list(RESPONSE_COLUMNS),
    )
