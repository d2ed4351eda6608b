"""What a flight costs with the network and with each form of the lattice, and how far they fly apart."""

import logging
import math
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import pandas as pd

from flexsurr.config.flight import FlightCondition, FlightSettings
from flexsurr.config.study import Integrator
from flexsurr.evaluation.airliner_flights import (
    EXCEEDANCE_COLUMNS,
    MOVED,
    Flight,
    described,
    flights_in,
    flown,
    flown_stepped,
    inputs_along,
    limit_exceedances,
    outputs,
    outputs_in,
    peak_errors,
)
from flexsurr.evaluation.airliner_models import ONE_MACH, REFERENCE, Airliner
from flexsurr.evaluation.columns import COST_COLUMNS, REBUILT
from flexsurr.evaluation.ratios import relative_percent
from flexsurr.evaluation.timing import wall_time
from flexsurr.flight.trim import Trim, TrimNotFound, trim
from flexsurr.simulation.mapping import CompiledMapping
from flexsurr.simulation.rhs import Array
from flexsurr.simulation.trajectory import Trajectory

log = logging.getLogger(__name__)

BASELINES = (REBUILT, REFERENCE, ONE_MACH, "quadratic")
NETWORK = "network"
TORCH = "network_torch"
"""The same network before its export: evaluated by torch in a simulation that Python steps."""

# A flight with these takes long enough to be a steady measure by itself.
SLOW = (REBUILT, REFERENCE, ONE_MACH, TORCH)
Coefficients = Callable[[Array], Array]
OfEachFlight = Callable[[FlightCondition], CompiledMapping]
# The paper's flights with the network over those with the lattice rebuilt, mean and standard deviation [%]:
# as a function of the language after export, and before, where the time came down by "approximately 45%".
PAPER_PERCENT: dict[str, tuple[float, float]] = {NETWORK: (0.995, 0.025), TORCH: (55.0, float("nan"))}


def fly_all(
    airliner: Airliner,
    aerodynamics: Mapping[str, CompiledMapping | OfEachFlight],
    references: pd.DataFrame,
    limits: tuple[Array, Array] | None = None,
    in_torch: Coefficients | None = None,
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Time the flights of `references` with every aerodynamics; compare their outputs with `REFERENCE`'s.

    Each flies from its own trim. The lattices, which are dear, are timed on the first few flights, as the
    settings say; `references` (`reference_flights`) knows how the frozen ones fly the others. A flight
    without a trim is left out, and the log says so. An aerodynamics may be a function that makes it for each
    flight. `in_torch` flies as `TORCH` from the trim of the network. `limits` are those of its training.

    First frame, a row per model and flight: model, flight, control, mach, altitude_m, amplitude_deg, wall_s
    (NaN where it is not timed), aerodynamics_percent (the share of the aerodynamics in it, of the first few
    flights), completed, and for each output that the doublet moves <output>_error_percent. Second:
    `limit_exceedances` of the flights with the network.
    """
    random = airliner.settings.random_flights
    fewer = {
        REBUILT: random.rebuild_flights,
        REFERENCE: random.frozen_flights,
        ONE_MACH: random.frozen_flights,
    }
    flights, known = flights_in(references), outputs_in(references)
    rows: list[dict[str, object]] = []
    exceedances: list[pd.DataFrame] = []
    for place, flight in enumerate(flights):
        exact = known[REFERENCE, flight.number]
        with_share = place < random.rebuild_flights
        for model, form in aerodynamics.items():
            if place >= fewer.get(model, len(flights)):
                if (model, flight.number) in known:
                    rows.append(_row(model, flight, known[model, flight.number], exact))
                continue
            mapping = form if isinstance(form, CompiledMapping) else form(flight.condition)
            try:
                start = trim(airliner.flying(mapping), flight.condition, airliner.settings.limits)
            except TrimNotFound as error:
                log.warning("flight %d, %s: %s", flight.number, model, error)
                continue
            trajectory, *times = _timed(model, start, flight, airliner.settings, flown, mapping, with_share)
            rows.append(_row(model, flight, outputs(trajectory), exact, *times))
            if model == NETWORK and in_torch is not None:
                stepped = partial(flown_stepped, coefficients=in_torch)
                before, *times = _timed(
                    TORCH, start, flight, airliner.settings, stepped, in_torch, with_share
                )
                rows.append(_row(TORCH, flight, outputs(before), exact, *times))
            if model == NETWORK and limits is not None:
                exceedances.append(limit_exceedances(start, flight, trajectory, airliner.settings, *limits))
        log.info(
            "flight %d of %d: %s of %.1f deg at Mach %.3f",
            place + 1,
            len(flights),
            flight.control,
            flight.amplitude_deg,
            flight.condition.mach,
        )
    none = pd.DataFrame(columns=EXCEEDANCE_COLUMNS)
    return pd.DataFrame(rows), pd.concat(exceedances, ignore_index=True) if exceedances else none


def _row(
    model: str,
    flight: Flight,
    found: Mapping[str, Array],
    exact: Mapping[str, Array],
    wall_s: float = math.nan,
    aerodynamics_percent: float = math.nan,
) -> dict[str, object]:
    """The row of a flight with the outputs `found`."""
    names = MOVED[flight.control]
    errors = {} if model == REFERENCE else peak_errors(exact, found, names)
    return {
        "model": model,
        **described(flight),
        "wall_s": wall_s,
        "aerodynamics_percent": aerodynamics_percent,
        "completed": len(found[names[0]]) == len(exact[names[0]]),
        **{f"{name}_error_percent": error for name, error in errors.items()},
    }


def _timed(
    model: str,
    start: Trim,
    flight: Flight,
    settings: FlightSettings,
    fly: Callable[[Trim, Flight, FlightSettings], Trajectory],
    coefficients: Coefficients,
    with_share: bool,
) -> tuple[Trajectory, float, float]:
    """A flight, its wall time [s], and the share of the aerodynamics in it [%], NaN unless asked for."""
    repeats = 1 if model in SLOW else settings.random_flights.repeats
    if with_share:  # a single step loads or compiles what the timed flights use
        fly(start, flight, settings.model_copy(update={"duration_s": settings.step_s}))
    trajectory, wall_s = wall_time(partial(fly, start, flight, settings), repeats)
    if not with_share:
        return trajectory, wall_s, math.nan
    inputs = inputs_along(start, flight, trajectory, settings)
    coefficients(inputs[0])
    once = partial(_one_by_one, coefficients, inputs) if model == TORCH else partial(coefficients, inputs)
    _, spent_s = wall_time(once, repeats)
    return trajectory, wall_s, 100.0 * spent_s * trajectory.evaluations / len(inputs) / wall_s


def _one_by_one(coefficients: Coefficients, inputs: Array) -> None:
    for u in inputs:
        coefficients(u)


def airliner_cost(flights: pd.DataFrame) -> pd.DataFrame:
    """One row per model: simulations, wall_s_mean, wall_s_std, relative_to_<baseline>_percent and its spread.

    Relative costs are means over the flights on which both have been timed; where the baseline has been timed
    on fewer (`<baseline>_flights`), its mean stands for the rest: every flight has the same steps.
    worst_error_percent is the worst of all outputs and flights, median_error_percent the median flight's.
    aerodynamics_percent is the mean share of the aerodynamics in the wall time, paper_percent what the paper
    has for the network over the rebuilt lattice.
    """
    finished = flights[flights["completed"] & flights["wall_s"].notna()]
    walls = {str(model): group.set_index("flight")["wall_s"] for model, group in finished.groupby("model")}
    errors = [column for column in flights.columns if column.endswith("_error_percent")]
    rows = []
    for model, group in flights.groupby("model", sort=False):
        done = group[group["completed"]]
        row: dict[str, object] = {
            "model": model,
            "simulations": len(group),
            "wall_s_mean": done["wall_s"].mean(),
            "wall_s_std": done["wall_s"].std(),
            "aerodynamics_percent": done["aerodynamics_percent"].mean(),
        }
        for baseline in BASELINES:
            base = walls.get(baseline)
            if base is not None:
                everywhere = base.reindex(walls[str(model)].index).fillna(base.mean())
                mean, spread = relative_percent(walls.get(str(model)), everywhere)
            else:
                mean, spread = float("nan"), float("nan")
            row[f"relative_to_{baseline}_percent"] = mean
            row[f"relative_to_{baseline}_std_percent"] = spread
            row[f"{baseline}_flights"] = 0 if base is None else len(base)
        worst = done[errors].max(axis=1) if errors else pd.Series(dtype=np.float64)
        row["median_error_percent"] = worst.median()
        row["worst_error_percent"] = worst.max()
        row["diverged"] = int((~group["completed"]).sum())
        row["paper_percent"], row["paper_std_percent"] = PAPER_PERCENT.get(str(model), (float("nan"),) * 2)
        rows.append(row)
    return pd.DataFrame(rows)


def as_cost_rows(cost: pd.DataFrame, boundary_condition: str, step_s: float) -> pd.DataFrame:
    """`airliner_cost` in the columns of cost.csv, so that it can stand among the other studies' rows.

    The described baseline is the lattice rebuilt at every call, which the study's percentage is of; the
    compiled one is the lattice frozen at one Mach number. tip_error_percent is the worst error. The network
    in torch is the model "network" in that implementation.
    """
    rows = cost.assign(
        study="airliner",
        variant=boundary_condition,
        response="manoeuvre",
        model=cost["model"].replace(TORCH, NETWORK),
        implementation=["torch" if model == TORCH else "compiled" for model in cost["model"]],
        integrator=Integrator(method="rk4", step_s=step_s).label,
        relative_to_described_percent=cost[f"relative_to_{REBUILT}_percent"],
        relative_to_described_std_percent=cost[f"relative_to_{REBUILT}_std_percent"],
        relative_to_numpy_percent=float("nan"),
        relative_to_compiled_percent=cost[f"relative_to_{ONE_MACH}_percent"],
        tip_error_percent=cost["worst_error_percent"],
        energy_drift_percent=float("nan"),
    )
    return rows[list(COST_COLUMNS)]


def exceedance_summary(exceedances: pd.DataFrame) -> pd.DataFrame:
    """Per input: flights and samples outside the training limits, of how many, and the worst distance."""
    grouped = exceedances.groupby("input", sort=False)
    return pd.DataFrame(
        {
            "flights": grouped["flight"].nunique(),
            "flights_outside": grouped["outside"].agg(lambda outside: int((outside > 0).sum())),
            "samples": grouped["samples"].sum(),
            "samples_outside": grouped["outside"].sum(),
            "worst_half_intervals": grouped["worst"].max(),
        }
    ).reset_index()
