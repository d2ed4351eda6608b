"""Full order beside reduced order under the study's load, from rest: how much the reduction loses."""

import numpy as np
import pandas as pd

from flexsurr.beam import ModalBasis, find_equilibrium, full_order, loaded, reduced_order
from flexsurr.config.study import Study
from flexsurr.evaluation.cases import excitation, rest_state
from flexsurr.simulation import simulate

VALIDATION_COLUMNS = ("variant", "model", "t_s", "tip_x_m", "tip_z_m")

INTERVALS = 1000
"""Between the times at which a response is kept, however long it lasts."""


def validation_table(study: Study, basis: ModalBasis) -> pd.DataFrame:
    """From rest under the study's load, for its validation_duration_s; columns `VALIDATION_COLUMNS`.

    Tip positions in [m]. One block of rows for each of the study's variants and each model, "fom" and
    "rom". A trajectory that ends early ends its rows.
    """
    structure = basis.structure
    duration_s = study.evaluation.validation_duration_s
    t = np.linspace(0.0, duration_s, INTERVALS + 1)
    integrator = study.evaluation.validation_integrator
    load = excitation(study.evaluation, duration_s)
    equilibrium = find_equilibrium(structure)
    rest = np.concatenate([equilibrium, np.zeros_like(equilibrium)])
    frames = []
    for variant in study.variants:
        fom = full_order(structure, variant, "compiled")
        rom = reduced_order(basis, variant, "compiled")
        for name, model, place, start in (
            ("fom", fom, structure, rest),
            ("rom", rom, basis, rest_state(basis)),
        ):
            trajectory = simulate(loaded(model, place, load, "compiled"), t, start, integrator)
            tip = model.tip(trajectory.x)
            frames.append(
                pd.DataFrame(
                    {
                        "variant": variant,
                        "model": name,
                        "t_s": trajectory.t,
                        "tip_x_m": tip[:, 0],
                        "tip_z_m": tip[:, 2],
                    }
                )
            )
    return pd.concat(frames, ignore_index=True)[list(VALIDATION_COLUMNS)]
