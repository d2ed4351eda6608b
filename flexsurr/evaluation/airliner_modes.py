"""Elastic modes of the airliner, and its small motions with a surrogate and with its lattice: Fig. 18."""

from dataclasses import replace

import pandas as pd

from flexsurr.aerodynamics.features import MODES as AERODYNAMIC_MODES
from flexsurr.aerodynamics.mach_grid import fixed_machs
from flexsurr.aerodynamics.quadratic import quadratic
from flexsurr.evaluation.airliner_models import Airliner
from flexsurr.flight.airliner import modal_motion
from flexsurr.flight.linearise import linearise
from flexsurr.flight.model import FlightModel
from flexsurr.flight.modes import mode_names, motions
from flexsurr.flight.trim import Trim, trim

# The paper's numbers of the six modes that the aerodynamics knows (text to its Fig. 21): three symmetric
# about the airliner y = 0, three "asymmetric".
PAPER_SYMMETRIC, PAPER_ANTISYMMETRIC = (1, 6, 7), (2, 5, 8)


def elastic_modes(airliner: Airliner) -> pd.DataFrame:
    """What each elastic mode is, and which of the paper's it corresponds to.

    Columns: mode, frequency_hz, symmetric, name, share_percent (of the mode's kinetic energy, in what the
    name says), also, also_percent (the next largest), in_aerodynamics, paper_mode. Modes correspond by their
    order among the symmetric and among the antisymmetric ones that the aerodynamics knows; `paper_mode` is
    missing for others, and for all where there are not three of each.
    """
    modes, chosen = airliner.modes, airliner.settings.aerodynamic_modes
    corresponding: dict[int, int] = {}
    for symmetric, published in ((True, PAPER_SYMMETRIC), (False, PAPER_ANTISYMMETRIC)):
        ours = [k for k in sorted(chosen) if modes.symmetric[k - 1] == symmetric]
        corresponding |= dict(zip(ours, published, strict=False)) if len(ours) == len(published) else {}
    corresponding = corresponding if len(corresponding) == len(chosen) else {}
    rows = []
    for k, (name, ranked) in enumerate(zip(mode_names(modes), motions(modes), strict=True), start=1):
        rows.append(
            {
                "mode": k,
                "frequency_hz": modes.frequency_hz[k - 1],
                "symmetric": modes.symmetric[k - 1],
                "name": name,
                "share_percent": 100.0 * ranked[0].share,
                "also": ranked[1].name,
                "also_percent": 100.0 * ranked[1].share,
                "in_aerodynamics": k in chosen,
                "paper_mode": corresponding.get(k),
            }
        )
    return pd.DataFrame(rows).astype({"paper_mode": "Int64"})


def airliner_modes(reference: Trim, surrogate: Trim | None) -> pd.DataFrame:
    """Eigenvalues [1/s] of both, matched by the names their eigenvectors give them.

    Columns `MODE_COLUMNS`, and `error_percent` of the eigenvalue's magnitude. A mode that only one of them
    has is NaN for the other, and so is everything of a surrogate that there is not.
    """
    values = [
        {mode.name: mode.eigenvalue for mode in linearise(trim)} if trim is not None else {}
        for trim in (reference, surrogate)
    ]
    rows = []
    for name in dict.fromkeys([*values[0], *values[1]]):
        exact, found = (each.get(name, complex("nan")) for each in values)
        rows.append(
            {
                "mode": name,
                "reference_real": exact.real,
                "reference_imag": exact.imag,
                "surrogate_real": found.real,
                "surrogate_imag": found.imag,
                "error_percent": 100.0 * abs(found - exact) / abs(exact),
            }
        )
    return pd.DataFrame(rows)


def left_out_modes(airliner: Airliner) -> pd.DataFrame:
    """What it changes that the aerodynamics does not know some of the elastic modes.

    It knows six at most, so the modes left out take the places of as many of the last ones in a second
    aerodynamics, the quadratic form, and are compared with a third that knows neither. Columns: mode,
    without_real, without_imag, with_real, with_imag [1/s], change_percent of the eigenvalue's magnitude.
    """
    settings = airliner.settings
    numbers = range(1, settings.elastic_modes + 1)
    left_out = tuple(k for k in numbers if k not in settings.aerodynamic_modes)[:AERODYNAMIC_MODES]
    kept = settings.aerodynamic_modes[: AERODYNAMIC_MODES - len(left_out)]
    grid = fixed_machs([settings.condition.mach])
    trims = []
    for chosen in (kept, tuple(sorted((*kept, *left_out)))):
        airframe = replace(
            airliner.airframe, motion=modal_motion(airliner.modes, airliner.airframe.lattice, chosen)
        )
        model = FlightModel(airliner.modes, quadratic(airframe, grid), chosen=chosen)
        trims.append(trim(model, settings.condition, settings.limits))
    frame = airliner_modes(*trims).rename(
        columns={
            "reference_real": "without_real",
            "reference_imag": "without_imag",
            "surrogate_real": "with_real",
            "surrogate_imag": "with_imag",
            "error_percent": "change_percent",
        }
    )
    # those that gave up their places are as in a vacuum in both
    unknown = [f"elastic {k}" for k in numbers if k not in (*kept, *left_out)]
    return frame[~frame["mode"].isin(unknown)].reset_index(drop=True)
