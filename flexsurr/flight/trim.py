"""Trim: straight and level flight of the flexible aircraft, lift, thrust and deformation in balance."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsurr.aerodynamics.features import onset_angles
from flexsurr.aerodynamics.standard_atmosphere import speed_of_sound
from flexsurr.config.flight import FlightCondition, TrimLimits
from flexsurr.flight.equations_of_motion import (
    ALTITUDE_M,
    PHI,
    RIGID_STATES,
    THETA,
    VELOCITY_IN_X,
    FlexibleAircraft,
    U,
    W,
)
from flexsurr.flight.model import FlightModel
from flexsurr.simulation.rhs import Array, evaluate

_ITERATIONS = 30
_STEP = 1e-4
_CONVERGED = 1e-9
# Their natural sizes: a degree, a tenth of the drag; residuals are accelerations as they are.
_SIZES = (0.02, 0.02, 5000.0, 0.02, 0.02, 0.02)
_ELASTIC_SIZE = 20.0  # kg^½ m
_RESIDUALS = (
    ("u_dot", "m/s²"),
    ("v_dot", "m/s²"),
    ("w_dot", "m/s²"),
    ("p_dot", "rad/s²"),
    ("q_dot", "rad/s²"),
    ("r_dot", "rad/s²"),
)


class TrimNotFound(Exception):
    """No straight and level flight within the limits: says where it was sought and what is left over."""


@dataclass(frozen=True, eq=False)
class Trim:
    """A trimmed flight: the model with its controls and thrust set, and the state (d,) that stays.

    `residual` is the largest of the accelerations left (m/s², rad/s², kg^½ m/s²).
    """

    model: FlightModel
    state: Array
    condition: FlightCondition
    residual: float

    @property
    def alpha_rad(self) -> float:
        """Angle of attack."""
        return float(onset_angles(*self.state[VELOCITY_IN_X])[1])

    @property
    def eta(self) -> Array:
        """Amplitudes (k,) of the elastic modes [kg^½ m]."""
        return self.state[RIGID_STATES : RIGID_STATES + len(self.model.modes.omega_rad_s)]


def trim(model: FlightModel, condition: FlightCondition, limits: TrimLimits | None = None) -> Trim:
    """Straight and level flight of `model` without its doublet, elevator in neutral, by Newton's method.

    Unknown are angle of attack, incidence of the horizontal tail, thrust and elastic amplitudes; bank,
    aileron and rudder too, since nothing promises that a surrogate is symmetric. Sideslip is zero. Raises
    TrimNotFound with the residuals where it does not exist or lies beyond `limits`.
    """
    limits = limits or TrimLimits()
    problem = _Problem(model, condition)
    unknowns = np.zeros(problem.size)
    residual = problem.residuals(unknowns)
    for _ in range(_ITERATIONS):
        if not np.isfinite(residual).all():
            break
        if np.abs(residual).max() < _CONVERGED:
            return _within(limits, problem, unknowns, residual)
        jacobian = np.empty((problem.size, problem.size))
        for j in range(problem.size):
            step = np.zeros(problem.size)
            step[j] = _STEP
            ahead, behind = problem.residuals(unknowns + step), problem.residuals(unknowns - step)
            jacobian[:, j] = (ahead - behind) / (2.0 * _STEP)
        try:
            change = np.linalg.solve(jacobian, -residual)
        except np.linalg.LinAlgError:
            break
        before = np.abs(residual).max()
        unknowns = unknowns + change
        residual = problem.residuals(unknowns)
        # rounding of dear accelerations stops above the bound
        if before < 1e3 * _CONVERGED and np.abs(residual).max() >= 0.5 * before:
            return _within(limits, problem, unknowns, residual)
    raise TrimNotFound(
        f"{problem.where}: no trim found in {_ITERATIONS} iterations; left: {problem.left(residual)}"
    )


def trim_envelope(
    model: FlightModel, conditions: Sequence[FlightCondition], limits: TrimLimits | None = None
) -> tuple[list[Trim], list[str]]:
    """Trims at all `conditions` that have one, and for the others why not."""
    found, missing = [], []
    for condition in conditions:
        try:
            found.append(trim(model, condition, limits))
        except TrimNotFound as error:
            missing.append(str(error))
    return found, missing


class _Problem:
    """Accelerations of a level flight as a function of scaled unknowns."""

    def __init__(self, model: FlightModel, condition: FlightCondition) -> None:
        self.model = model.with_doublet(None)
        self.condition = condition
        self.where = f"Mach {condition.mach:g} at {condition.altitude_m:g} m"
        self._kernel: FlexibleAircraft = self.model.kernel
        self._modes = len(model.modes.omega_rad_s)
        self._speed = condition.mach * speed_of_sound(condition.altitude_m)
        self._work = np.empty(model.work_size)
        self.size = len(_SIZES) + self._modes
        self._sizes = np.array([*_SIZES, *(_ELASTIC_SIZE,) * self._modes])

    def state(self, unknowns: Array) -> Array:
        """The state (d,) of level flight with these unknowns."""
        alpha, _, _, phi, *_ = values = unknowns * self._sizes
        x = np.zeros(RIGID_STATES + 2 * self._modes)
        x[ALTITUDE_M] = self.condition.altitude_m
        x[PHI] = phi
        x[THETA] = np.arctan(np.cos(phi) * np.tan(alpha))  # no climb
        x[U], x[W] = self._speed * np.cos(alpha), self._speed * np.sin(alpha)
        x[RIGID_STATES : RIGID_STATES + self._modes] = values[len(_SIZES) :]
        return x

    def controls(self, unknowns: Array) -> tuple[float, ...]:
        """The six controls [rad]."""
        _, incidence, _, _, aileron, rudder, *_ = (float(value) for value in unknowns * self._sizes)
        return (incidence, 0.0, 0.0, aileron, -aileron, rudder)

    def thrust(self, unknowns: Array) -> float:
        """Thrust [N]."""
        return float(unknowns[2] * self._sizes[2])

    def residuals(self, unknowns: Array) -> Array:
        """Accelerations: translation, rotation, elastic modes."""
        kernel = self._kernel._replace(
            controls=np.array(self.controls(unknowns)), thrust=self.thrust(unknowns)
        )
        x = self.state(unknowns)
        dx = np.empty_like(x)
        evaluate(kernel, 0.0, x, dx, self._work)
        return np.concatenate([dx[U:RIGID_STATES], dx[RIGID_STATES + self._modes :]])

    def left(self, residual: Array) -> str:
        """Residuals in words, the largest elastic one alone."""
        rigid = [
            f"{name} {value:.3g} {unit}" for (name, unit), value in zip(_RESIDUALS, residual, strict=False)
        ]
        elastic = residual[len(_RESIDUALS) :]
        worst = int(np.argmax(np.abs(elastic)))
        return ", ".join([*rigid, f"eta_{worst + 1}_ddot {elastic[worst]:.3g} kg^0.5 m/s²"])


def _within(limits: TrimLimits, problem: _Problem, unknowns: Array, residual: Array) -> Trim:
    state, controls, thrust = problem.state(unknowns), problem.controls(unknowns), problem.thrust(unknowns)
    alpha = float(np.degrees(onset_angles(*state[VELOCITY_IN_X])[1]))
    beyond = []
    clipped = unknowns.copy()
    checks = (
        ("alpha", alpha, "°", limits.alpha_deg, np.radians(1.0)),
        ("i_t", float(np.degrees(controls[0])), "°", limits.incidence_deg, np.radians(1.0)),
        ("thrust", thrust, " N", limits.thrust_N, 1.0),
    )
    for place, (name, value, unit, (low, high), to_si) in enumerate(checks):
        if not low <= value <= high:
            beyond.append(f"{name} {value:.4g}{unit} lies outside {low:g} to {high:g}{unit}")
            clipped[place] = np.clip(value, low, high) * to_si / _SIZES[place]
    if beyond:
        raise TrimNotFound(
            f"{problem.where}: no trim: {'; '.join(beyond)}; left at the limit: "
            f"{problem.left(problem.residuals(clipped))}"
        )
    model = replace(problem.model, controls=controls, thrust_N=thrust)
    return Trim(model, state, problem.condition, float(np.abs(residual).max()))
