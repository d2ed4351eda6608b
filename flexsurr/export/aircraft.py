"""The airliner in flight as expressions: equations of motion with a learned map as the aerodynamics.

The equations are those of `flexsurr.flight.equations_of_motion`, where their source stands.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexsurr import __version__
from flexsurr.aerodynamics.features import (
    COEFFICIENT_UNITS,
    COEFFICIENTS,
    FEATURES,
    FIRST_CONTROL,
    FIRST_ETA,
    FIRST_MODAL,
    MODES,
)
from flexsurr.aerodynamics.standard_atmosphere import (
    GAS_CONSTANT,
    GRAVITY,
    HEAT_RATIO,
    LAPSE_RATE,
    SEA_LEVEL_PRESSURE,
    SEA_LEVEL_TEMPERATURE,
    TROPOPAUSE,
    TROPOPAUSE_TEMPERATURE,
)
from flexsurr.export.expressions import Value, argument, concat, constant, each, matmul, where
from flexsurr.export.formulas import NotExported, outputs_of_map
from flexsurr.export.model import ExportedModel, Quantity, recommended_step
from flexsurr.flight.equations_of_motion import (
    ALTITUDE_M,
    ATTITUDE,
    PHI,
    RATES_IN_X,
    RIGID_STATES,
    VELOCITY_IN_X,
)
from flexsurr.flight.model import FlightModel, airless
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import LearnedMap

CONTROLS = FEATURES[FIRST_CONTROL:FIRST_ETA]
EXPONENT = GRAVITY / (GAS_CONSTANT * LAPSE_RATE)
TROPOPAUSE_PRESSURE = SEA_LEVEL_PRESSURE * (TROPOPAUSE_TEMPERATURE / SEA_LEVEL_TEMPERATURE) ** EXPONENT

OUTPUTS = (
    Quantity("airspeed_m_s", "m/s", "speed through the air"),
    Quantity("mach", "1", "Mach number"),
    Quantity("alpha", "rad", "angle of attack"),
    Quantity("beta", "rad", "angle of sideslip"),
)


@dataclass(frozen=True, eq=False)
class _Air:
    """What the state (d,) meets: V [m/s], M, α, β [rad], and q̄ S [N]."""

    speed: Value
    mach: Value
    alpha: Value
    beta: Value
    force: Value


def exported_aircraft(
    model: FlightModel, state: Array, learned: LearnedMap, name: str, about: Sequence[str] = ()
) -> ExportedModel:
    """The aircraft of `model` with `learned` as its aerodynamics, from `state` (d,) on.

    Inputs are the six controls [rad] and the thrust [N], at the model's values to start with; outputs are
    airspeed, Mach number, onset angles and the twelve coefficients. Raises NotExported for a map that is no
    aerodynamics.
    """
    check_aerodynamics(learned, name)
    modes = len(model.modes.omega_rad_s)
    x, u = argument("x", len(state)), argument("u", len(CONTROLS) + 1)
    air = _air(model, x)
    coefficients = outputs_of_map(learned, _features(model, x, u, air))
    start = (*model.controls, model.thrust_N)
    ranges = dict(
        zip(
            FEATURES, zip(learned.inputs.low.tolist(), learned.inputs.high.tolist(), strict=True), strict=True
        )
    )
    units = ("rad",) * len(CONTROLS) + ("N",)
    return ExportedModel(
        name=name,
        about=(*about, f"Written by flexsurr {__version__}."),
        states=tuple(
            Quantity(of, unit, "state", value)
            for of, unit, value in zip(model.state_names, model.state_units, state.tolist(), strict=True)
        ),
        inputs=tuple(
            Quantity(
                of, unit, "thrust" if of == "thrust_N" else "control", value, *ranges.get(of, (None, None))
            )
            for of, unit, value in zip((*CONTROLS, "thrust_N"), units, start, strict=True)
        ),
        outputs=(
            *OUTPUTS,
            *(
                Quantity(of, unit, "aerodynamic coefficient")
                for of, unit in zip(COEFFICIENTS, COEFFICIENT_UNITS, strict=True)
            ),
        ),
        x=x,
        u=u,
        rates=_motion(model, x, u[len(CONTROLS)], air, coefficients, modes),
        results=concat([air.speed, air.mach, air.alpha, air.beta, coefficients]),
        step_s=recommended_step(lambda at: model.derivative(0.0, at), state, np.maximum(np.abs(state), 1.0)),
    )


def check_aerodynamics(learned: LearnedMap, name: str) -> None:
    """Raise NotExported for a map that is no aerodynamics."""
    if learned.inputs.names != FEATURES or learned.output_names != COEFFICIENTS:
        raise NotExported(
            f"{name}: not a map of the {len(FEATURES)} features to {len(COEFFICIENTS)} coefficients"
        )


def _air(model: FlightModel, x: Value) -> _Air:
    u, v, w = _parts(x[VELOCITY_IN_X])
    altitude = x[ALTITUDE_M]
    below = each("lt", altitude, TROPOPAUSE)
    cooling = SEA_LEVEL_TEMPERATURE - LAPSE_RATE * altitude
    temperature = where(below, cooling, TROPOPAUSE_TEMPERATURE)
    # held above zero where it is not chosen
    ratio = each("maximum", cooling, 1.0) / SEA_LEVEL_TEMPERATURE
    fall = each("exp", (TROPOPAUSE - altitude) * (GRAVITY / (GAS_CONSTANT * TROPOPAUSE_TEMPERATURE)))
    pressure = where(below, SEA_LEVEL_PRESSURE * each("pow", ratio, EXPONENT), TROPOPAUSE_PRESSURE * fall)
    density = pressure / (GAS_CONSTANT * temperature)
    squared = u * u + v * v + w * w
    speed = each("sqrt", squared)
    return _Air(
        speed,
        speed / each("sqrt", HEAT_RATIO * GAS_CONSTANT * temperature),
        each("atan2", w, u),
        each("asin", v / speed),
        0.5 * airless(model).area * density * squared,
    )


def _features(model: FlightModel, x: Value, u: Value, air: _Air) -> Value:
    """The 25 inputs of the aerodynamics."""
    modes = len(model.modes.omega_rad_s)
    over = 1.0 / air.speed
    eta, rates = [], []
    for place in airless(model).places.astype(int).tolist():
        eta.append(x[RIGID_STATES + place] if place >= 0 else constant(0.0))
        rates.append(x[RIGID_STATES + modes + place] * over if place >= 0 else constant(0.0))
    return concat(
        [air.mach, x[ALTITUDE_M], air.alpha, air.beta, x[RATES_IN_X] * over, u[: len(CONTROLS)], *eta, *rates]
    )


def _motion(model: FlightModel, x: Value, thrust: Value, air: _Air, coefficients: Value, modes: int) -> Value:
    """ẋ (d,)."""
    constants = airless(model)
    u, v, w = _parts(x[VELOCITY_IN_X])
    p, q, r = _parts(x[RATES_IN_X])
    angles = x[PHI : PHI + len(ATTITUDE)]
    (sin_phi, sin_theta, sin_psi), (cos_phi, cos_theta, cos_psi) = (
        _parts(each(of, angles)) for of in ("sin", "cos")
    )
    lift, drag, side, pitch, roll, yaw = _parts(coefficients[:FIRST_MODAL])
    north = (
        cos_theta * cos_psi * u
        + (sin_phi * sin_theta * cos_psi - cos_phi * sin_psi) * v
        + (cos_phi * sin_theta * cos_psi + sin_phi * sin_psi) * w
    )
    east = (
        cos_theta * sin_psi * u
        + (sin_phi * sin_theta * sin_psi + cos_phi * cos_psi) * v
        + (cos_phi * sin_theta * sin_psi - sin_phi * cos_psi) * w
    )
    up = sin_theta * u - sin_phi * cos_theta * v - cos_phi * cos_theta * w
    turn = (q * sin_phi + r * cos_phi) / cos_theta
    # forces; α by its tangent w / u
    inclined = 1.0 / each("sqrt", u * u + w * w)
    sin_alpha, cos_alpha = w * inclined, u * inclined
    per_mass, g = air.force / constants.mass, constants.gravity
    u_dot = (
        per_mass * (sin_alpha * lift - cos_alpha * drag)
        + thrust / constants.mass
        - g * sin_theta
        - q * w
        + r * v
    )
    v_dot = per_mass * side + g * (cos_theta * sin_phi) - r * u + p * w
    w_dot = per_mass * (-(cos_alpha * lift) - sin_alpha * drag) + g * (cos_theta * cos_phi) - p * v + q * u
    # moments
    hx, hy, hz = _parts(matmul(constants.inertia, x[RATES_IN_X]))
    moments = concat(
        [
            constants.span * air.force * roll - (q * hz - r * hy),
            constants.chord * air.force * pitch + constants.thrust_height * thrust - (r * hx - p * hz),
            constants.span * air.force * yaw - (p * hy - q * hx),
        ]
    )
    # elastic modes
    eta, eta_dot = x[RIGID_STATES : RIGID_STATES + modes], x[RIGID_STATES + modes :]
    turned = np.zeros((MODES, modes))
    for i, place in enumerate(constants.places.astype(int).tolist()):
        if place >= 0:
            turned[i, place] = 1.0
    accelerations = (
        thrust * constants.thrust_shape
        - constants.damping * eta_dot
        - constants.omega_squared * eta
        + air.force * (coefficients[FIRST_MODAL:] @ turned)
    )
    return concat(
        [
            *(north, east, up),
            *(p + turn * sin_theta, q * cos_phi - r * sin_phi, turn),
            *(u_dot, v_dot, w_dot),
            matmul(constants.inverse_inertia, moments),
            eta_dot,
            accelerations,
        ]
    )


def _parts(vector: Value) -> list[Value]:
    return [vector[i] for i in range(vector.size)]
