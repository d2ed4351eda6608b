"""Small motions of the airliner with a surrogate beside those with its lattice: Fig. 18."""

from collections.abc import Iterable

import pandas as pd

from flexsurr.flight.linearise import NaturalMode, linearise
from flexsurr.flight.trim import Trim

MODE_COLUMNS = ("mode", "reference_real", "reference_imag", "surrogate_real", "surrogate_imag")


def airliner_modes(reference: Trim, surrogate: Trim) -> pd.DataFrame:
    """Eigenvalues [1/s] of both, matched by the names their eigenvectors give them.

    Columns `MODE_COLUMNS`, and `error_percent` of the eigenvalue's magnitude. A mode that only one of them
    has is NaN for the other.
    """
    values = [{mode.name: mode.eigenvalue for mode in linearise(trim)} for trim in (reference, surrogate)]
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


def eigenvalue_table(trims: Iterable[tuple[str, Trim]]) -> pd.DataFrame:
    """Columns model, mode, real, imag [1/s], for each named trim."""
    rows = []
    for model, trim in trims:
        modes: list[NaturalMode] = linearise(trim)
        rows += [
            {"model": model, "mode": m.name, "real": m.eigenvalue.real, "imag": m.eigenvalue.imag}
            for m in modes
        ]
    return pd.DataFrame(rows)
