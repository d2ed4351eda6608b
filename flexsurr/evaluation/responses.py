"""Responses of the reference and its surrogates, side by side, for the figures of the time histories."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from flexsurr.beam import ModalBasis, reduced_order
from flexsurr.config.study import Integrator, Study, Variant
from flexsurr.evaluation.accuracy import tip_error_percent
from flexsurr.evaluation.cases import (
    DRAWN_EVERY_S,
    Reference,
    Response,
    evaluation_cases,
    reference_solution,
    sample_times,
)
from flexsurr.evaluation.contenders import Contender, contenders
from flexsurr.simulation import simulate

RESPONSE_COLUMNS = (
    "variant",
    "response",
    "model",
    "t_s",
    "tip_x_m",
    "tip_z_m",
    "tip_error_percent",
    "load_end_s",
)

SURROGATE_INTEGRATOR = Integrator(method="dop853", rtol=1e-10, atol=1e-12)
"""Tight enough that what is drawn is the surrogate's error, not the integrator's."""


def response_table(
    study: Study, basis: ModalBasis, variant: Variant, response: Response, surrogates: Mapping[str, Any]
) -> pd.DataFrame:
    """The first simulation of `response`: model "reference" and each surrogate (Figs. 10 and 12).

    Columns `RESPONSE_COLUMNS`: tip position in the clamp's frame [m], distance from the reference in
    percent of its largest tip displacement, and the time [s] at which the load ends (0 where free). A
    trajectory that ends early ends its rows.
    """
    case = evaluation_cases(basis, study, response)[0]
    t = sample_times(study.evaluation.duration_s, min(study.evaluation.output_step_s, DRAWN_EVERY_S))
    reference = reference_solution(basis, variant, case, t)
    models = [
        c
        for c in contenders(basis, variant, surrogates)
        if c.implementation == "compiled" and c.model != "rom"
    ]
    tips = {"reference": reference.tip}
    tips |= {contender.model: _tip(contender, basis, variant, reference) for contender in models}
    frames = [_frame(variant, response, model, reference, tip) for model, tip in tips.items()]
    return pd.concat(frames, ignore_index=True)


def _tip(contender: Contender, basis: ModalBasis, variant: Variant, reference: Reference) -> np.ndarray:
    model = contender.under(basis, reference.case)
    trajectory = simulate(model, reference.t, reference.case.x0, SURROGATE_INTEGRATOR)
    return reduced_order(basis, variant, "numpy").tip(trajectory.x)


def _frame(variant: str, response: str, model: str, reference: Reference, tip: np.ndarray) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "variant": variant,
            "response": response,
            "model": model,
            "t_s": reference.t[: tip.shape[0]],
            "tip_x_m": tip[:, 0],
            "tip_z_m": tip[:, 2],
            "tip_error_percent": tip_error_percent(reference, tip),
            "load_end_s": reference.case.free_from_s,
        },
        columns=list(RESPONSE_COLUMNS),
    )
