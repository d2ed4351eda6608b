"""When a surrogate pays, how much, and at what loss: the question of every study, answered by its costs."""

from typing import Any

import numpy as np
import pandas as pd

from flexsurr.evaluation.columns import REBUILT
from flexsurr.report.style import VARIANTS, has_family, label

ALLOWED_PERCENT = 1.0
"""The loss up to which a surrogate may stand for its reference: the worst error, in percent of the peak."""

AS_GOOD = 1.1
"""Up to this many times the least error a setup counts as one that errs least."""

ANSWER_COLUMNS = (
    "study",
    "response",
    "variant",
    "model",
    "pays",
    "times_as_fast",
    "tip_error_percent",
    "wall_s",
    "integrator",
    "reference",
    "reference_integrator",
    "reference_wall_s",
    "times_as_fast_as_numpy",
    "times_as_fast_as_described",
)

CASE = ["study", "response", "variant"]

READ = (*CASE, "model", "implementation", "integrator", "wall_s_mean", "tip_error_percent", "diverged")


def answer(cost: pd.DataFrame) -> pd.DataFrame:
    """answer.csv: each surrogate beside the fastest compiled reference, fastest first in each case.

    `cost`: the columns of cost.csv. A case is a study, a response and a variant. Of each model that setup
    stands which is fastest among those within ALLOWED_PERCENT or, where there is none, that err least; the
    reference by the same rule. pays: yes where that is within and faster. Models of which every simulation
    diverged are left out, and cases without a compiled reference. Raises KeyError naming a missing column.
    """
    missing = [name for name in READ if name not in cost.columns]
    if missing:
        raise KeyError(f"columns missing: {', '.join(missing)}")
    rows: list[dict[str, Any]] = []
    for names, of_case in cost[cost["wall_s_mean"].notna()].groupby(CASE, sort=False):
        references = of_case[of_case["model"].map(is_a_reference)]
        compiled = references["implementation"] == "compiled"
        if not compiled.any():
            continue
        # what all others are compared with has no error of its own
        reference = _setup(references[compiled].fillna({"tip_error_percent": 0.0}))
        baselines = {name: _wall_s(references, name) for name in ("numpy", "described")}
        surrogates = of_case[
            ~of_case["model"].map(is_a_reference) & (of_case["implementation"] == "compiled")
        ]
        for model, setups in surrogates.groupby("model", sort=False):
            setup = _setup(setups)
            wall_s = setup["wall_s_mean"]
            ratio = reference["wall_s_mean"] / wall_s
            row = dict(zip(CASE, names, strict=True)) | {
                "model": model,
                "pays": "yes" if _is_allowed(setup) and ratio > 1.0 else "no",
                "times_as_fast": ratio,
                "tip_error_percent": setup["tip_error_percent"],
                "wall_s": wall_s,
                "integrator": setup["integrator"],
                "reference": reference["model"],
                "reference_integrator": reference["integrator"],
                "reference_wall_s": reference["wall_s_mean"],
                **{f"times_as_fast_as_{name}": base / wall_s for name, base in baselines.items()},
            }
            rows.append(row)
    frame = pd.DataFrame(rows, columns=list(ANSWER_COLUMNS))
    # cases as they come, then what pays, then the fastest
    places = pd.DataFrame({name: pd.factorize(frame[name])[0] for name in CASE})
    places = places.assign(pays=frame["pays"] == "no", slow=-frame["times_as_fast"])
    return frame.loc[places.sort_values([*CASE, "pays", "slow"]).index].reset_index(drop=True)


def _wall_s(references: pd.DataFrame, baseline: str) -> float:
    """The wall time of a baseline; for the lattice, described is the one that is rebuilt at every call."""
    is_it = (references["implementation"] == baseline) | (
        (references["model"] == REBUILT) & (baseline == "described")
    )
    return float(references[is_it]["wall_s_mean"].min())


def is_a_reference(model: str) -> bool:
    """Whether it is what surrogates stand for: the reduced model, or a form of the vortex lattice."""
    return model in ("rom", "fom") or model.startswith("vlm_")


def in_words(table: pd.DataFrame) -> list[str]:
    """What to read in the table of `answer`, a paragraph for each study."""
    said = []
    for study, rows in table.groupby("study", sort=False):
        cases = rows.assign(pays=rows["pays"] == "yes").groupby(["response", "variant"])["pays"].max()
        within = rows[rows["tip_error_percent"] <= ALLOWED_PERCENT]
        if within.empty:
            said.append(f"{study}: {_none_in_words(rows)}")
            continue
        best = within.sort_values("times_as_fast").iloc[-1]
        pays = (
            f"a surrogate pays in {cases.sum()} of {len(cases)} cases" if cases.any() else "no surrogate pays"
        )
        said.append(f"{study}: {pays}. {_best_in_words(best)}")
    return said


def _none_in_words(rows: pd.DataFrame) -> str:
    none = f"no surrogate stays within {ALLOWED_PERCENT:g} % of the peak."
    known = rows[rows["tip_error_percent"].notna()].sort_values("tip_error_percent", kind="stable")
    if known.empty:
        return none
    best = known.iloc[0]
    model, ratio = name_of(best["model"]), times(best["times_as_fast"])
    return (
        f"{none} The one that errs least, {model}, does so by {best['tip_error_percent']:.2g} %, and is "
        f"{ratio} times as fast as the compiled reference, {name_of(best['reference'])}."
    )


def _best_in_words(best: "pd.Series[Any]") -> str:
    variant = VARIANTS.get(best["variant"], best["variant"].replace("_", " "))
    described = best["times_as_fast_as_described"]
    also = "" if pd.isna(described) else f" and {times(described)} times as fast as the described baseline"
    model, ratio = name_of(best["model"]), times(best["times_as_fast"])
    return (
        f"The fastest within {ALLOWED_PERCENT:g} %, {model}, is {ratio} times as fast as the compiled "
        f"reference, {name_of(best['reference'])},{also} at a loss of "
        f"{best['tip_error_percent']:.1g} % ({best['response']}, {variant})."
    )


def name_of(model: str) -> str:
    """A model's name in figures; of a form of the aerodynamics that of its rows."""
    return label(model) if has_family(model) else model.replace("_", " ")


def times(ratio: float) -> str:
    """How many times as fast, in two digits, or three from ten on."""
    return f"{ratio:.2g}" if ratio < 10.0 else f"{float(f'{ratio:.3g}'):,.0f}"


def _setup(setups: pd.DataFrame) -> "pd.Series[Any]":
    """The fastest that is allowed or, where none is, of those that err least."""
    allowed = setups[[_is_allowed(setup) for _, setup in setups.iterrows()]]
    if len(allowed):
        candidates = allowed
    else:
        errors = setups["tip_error_percent"].fillna(np.inf)
        candidates = setups[errors <= AS_GOOD * errors.min()]
    fastest: pd.Series[Any] = candidates.sort_values("wall_s_mean", kind="stable").iloc[0]
    return fastest


def _is_allowed(setup: "pd.Series[Any]") -> bool:
    return bool(setup["tip_error_percent"] <= ALLOWED_PERCENT and not setup["diverged"])
