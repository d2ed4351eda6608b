"""Flights of the airliner by which models are compared: what they are, what they give, how far apart."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from flexsurr.aerodynamics.features import FEATURES, onset_angles
from flexsurr.config.aerodynamics import FeatureLimits
from flexsurr.config.flight import CONTROL_NAMES, Control, FlightCondition, FlightSettings
from flexsurr.flight.equations_of_motion import ATTITUDE, EARTH, RATES, VELOCITY
from flexsurr.flight.manoeuvres import doublet, fly, fly_stepped
from flexsurr.flight.model import Doublet, features
from flexsurr.flight.trim import Trim, TrimNotFound
from flexsurr.simulation.rhs import Array
from flexsurr.simulation.trajectory import Trajectory

LONGITUDINAL = ("airspeed_m_s", "alpha_deg", "theta_deg", "q_deg_s")
LATERAL = ("beta_deg", "phi_deg", "p_deg_s", "r_deg_s")
_MOST_DRAWS = 200
# What each doublet is meant to move; the rest hardly moves, and its error says nothing.
MOVED: dict[Control, tuple[str, ...]] = {"elevator": LONGITUDINAL, "aileron": LATERAL, "rudder": LATERAL}


@dataclass(frozen=True)
class Flight:
    """A doublet from a trim."""

    number: int
    control: Control
    condition: FlightCondition
    amplitude_deg: float


def random_flights(
    settings: FlightSettings, limits: FeatureLimits, has_trim: Callable[[FlightCondition], bool]
) -> list[Flight]:
    """Each doublet as often as the settings say, at random conditions and amplitudes within `limits`.

    Conditions that have no trim are drawn anew. Flight k's numbers come from `default_rng([seed, k])`: they
    don't depend on how many there are. Raises TrimNotFound where none of many conditions has a trim, and
    ValueError for a control whose limits are narrower than the least amplitude.
    """
    random = settings.random_flights
    flights = []
    for number in range(len(CONTROL_NAMES) * random.of_each_doublet):
        draw = np.random.default_rng([random.seed, number])
        # neighbours are different doublets, so that the first few hold each of them
        control = CONTROL_NAMES[number % len(CONTROL_NAMES)]
        most = limits.deflection_deg(control)
        if most <= random.least_deg:
            raise ValueError(f"{control}: limits of {most:g}° leave no amplitude of {random.least_deg:g}°")
        condition = _with_trim(draw, limits, has_trim)
        amplitude = float(draw.uniform(random.least_deg, most) * draw.choice([-1.0, 1.0]))
        flights.append(Flight(number, control, condition, amplitude))
    return flights


def _with_trim(
    draw: np.random.Generator, limits: FeatureLimits, has_trim: Callable[[FlightCondition], bool]
) -> FlightCondition:
    for _ in range(_MOST_DRAWS):
        mach, altitude = (
            float(draw.uniform(limit.low, limit.high)) for limit in (limits.mach, limits.altitude_m)
        )
        condition = FlightCondition(mach=mach, altitude_m=altitude)
        if has_trim(condition):
            return condition
    raise TrimNotFound(f"none of {_MOST_DRAWS} conditions within the limits has a trim")


def flown(trim: Trim, flight: Flight, settings: FlightSettings) -> Trajectory:
    """The flight from its `trim`."""
    return fly(trim, _pilot(flight, settings), settings.duration_s, settings.step_s)


def flown_stepped(
    trim: Trim, flight: Flight, settings: FlightSettings, coefficients: Callable[[Array], Array]
) -> Trajectory:
    """The same flight stepped from Python, with the coefficients of any function."""
    return fly_stepped(trim, _pilot(flight, settings), coefficients, settings.duration_s, settings.step_s)


def inputs_along(trim: Trim, flight: Flight, trajectory: Trajectory, settings: FlightSettings) -> Array:
    """What the aerodynamics was given at the samples of a flight (m, 25)."""
    return features(trim.model.with_doublet(_pilot(flight, settings)), trajectory.t, trajectory.x)


def _pilot(flight: Flight, settings: FlightSettings) -> Doublet:
    return doublet(flight.control, np.radians(flight.amplitude_deg), settings.doublet)


def outputs(trajectory: Trajectory) -> dict[str, Array]:
    """Over time: airspeed, angle of attack and sideslip, every rigid-body state, and each η [kg^½ m].

    Angles and rates in degrees; the unit ends the name.
    """
    states = dict(zip(trajectory.state_names, trajectory.x.T, strict=True))
    airspeed, alpha, beta = onset_angles(*(states[name] for name in VELOCITY))
    result = {name: states[name] for name in EARTH}
    result |= {f"{name}_m_s": states[name] for name in VELOCITY}
    result |= {f"{name}_deg": np.degrees(states[name]) for name in ATTITUDE}
    result |= {f"{name}_deg_s": np.degrees(states[name]) for name in RATES}
    result |= {"airspeed_m_s": airspeed, "alpha_deg": np.degrees(alpha), "beta_deg": np.degrees(beta)}
    etas = [name for name in states if name.startswith("eta_") and "dot" not in name]
    return result | {name: states[name] for name in etas}


def peak_errors(
    exact: Mapping[str, Array], found: Mapping[str, Array], names: Sequence[str]
) -> dict[str, float]:
    """Largest difference of `outputs` over the largest change of the `exact` ones from their start [%].

    NaN where the other flight ended early, or where the reference does not change.
    """
    errors = {}
    for name in names:
        peak = float(np.abs(exact[name] - exact[name][0]).max())
        if len(found[name]) != len(exact[name]) or peak == 0.0:
            errors[name] = float("nan")
            continue
        errors[name] = 100.0 * float(np.abs(found[name] - exact[name]).max()) / peak
    return errors


DESCRIBED = ("flight", "control", "mach", "altitude_m", "amplitude_deg")
COMPARED = (*LONGITUDINAL, *LATERAL)


def described(flight: Flight) -> dict[str, object]:
    """The flight in the columns `DESCRIBED`."""
    condition = flight.condition
    return dict(
        zip(
            DESCRIBED,
            (flight.number, flight.control, condition.mach, condition.altitude_m, flight.amplitude_deg),
            strict=True,
        )
    )


def history(model: str, flight: Flight, trajectory: Trajectory) -> pd.DataFrame:
    """A flight over time: model, `DESCRIBED`, and the outputs `COMPARED`."""
    compared = {name: values for name, values in outputs(trajectory).items() if name in COMPARED}
    return pd.DataFrame({"model": model, **described(flight), **compared})


def flights_in(histories: pd.DataFrame) -> list[Flight]:
    """The flights that `histories` are of, in their order."""
    rows = histories[list(DESCRIBED)].drop_duplicates()
    return [
        Flight(number, control, FlightCondition(mach=mach, altitude_m=altitude), amplitude)
        for number, control, mach, altitude, amplitude in rows.itertuples(index=False)
    ]


def outputs_in(histories: pd.DataFrame) -> dict[tuple[str, Hashable], dict[str, Array]]:
    """The outputs `COMPARED` by model and number of the flight."""
    return {
        (str(model), number): {name: one[name].to_numpy() for name in COMPARED}
        for model, of_model in histories.groupby("model")
        for number, one in of_model.groupby("flight")
    }


EXCEEDANCE_COLUMNS = ("flight", "control", "input", "samples", "outside", "worst")


def limit_exceedances(
    trim: Trim, flight: Flight, trajectory: Trajectory, settings: FlightSettings, low: Array, high: Array
) -> pd.DataFrame:
    """How often each input of a network left the limits (25,) of its training during a flight.

    Columns `EXCEEDANCE_COLUMNS`: outside (samples), worst (how far beyond, in halves of the interval).
    """
    inputs = inputs_along(trim, flight, trajectory, settings)
    beyond = np.maximum(low - inputs, inputs - high)
    # what rounding makes of a value on the limit itself is not outside
    outside = beyond > 1e-9 * np.maximum(np.abs(low), np.abs(high))
    return pd.DataFrame(
        {
            "flight": flight.number,
            "control": flight.control,
            "input": FEATURES,
            "samples": len(inputs),
            "outside": outside.sum(axis=0),
            "worst": np.maximum(beyond.max(axis=0), 0.0) / (0.5 * (high - low)),
        }
    )
