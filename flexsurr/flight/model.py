"""The airliner in flight as a model that `simulate` takes: modes, an aerodynamics, and its controls."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from flexsurr.aerodynamics.features import CONTROLS, FEATURES, MODES
from flexsurr.aerodynamics.standard_atmosphere import GRAVITY
from flexsurr.flight.airliner import DEFAULT_MODES
from flexsurr.flight.equations_of_motion import (
    ALTITUDE_M,
    RATES_IN_X,
    RIGID_STATES,
    SCRATCH,
    VELOCITY_IN_X,
    FlexibleAircraft,
    features_along,
    state_names,
    state_units,
)
from flexsurr.flight.modes import FreeModes
from flexsurr.simulation.mapping import CompiledMapping
from flexsurr.simulation.rhs import Array, ByKernel

TO_BODY = np.diag([-1.0, 1.0, -1.0])
"""From geometry axes (x aft, z up) to body axes (x forward, z down); a rotation, so for axial vectors too."""


@dataclass(frozen=True, eq=False)
class Doublet:
    """A pilot's input: `command` (6,) [rad] is added to the controls, then taken from them.

    From `times_s`[0] to [1] and from [1] to [2].
    """

    command: Array
    times_s: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class FlightModel(ByKernel):
    """A flexible aircraft with constant thrust [N] and controls (6,) [rad], and a doublet on top.

    Its states are those of `flexsurr.flight.equations_of_motion`. `chosen` are the numbers (from 1) of the
    modes that the aerodynamics knows.
    """

    modes: FreeModes
    aerodynamics: CompiledMapping
    chosen: tuple[int, ...] = DEFAULT_MODES
    controls: tuple[float, ...] = (0.0,) * CONTROLS
    thrust_N: float = 0.0
    doublet: Doublet | None = None
    gravity_m_s2: float = GRAVITY

    def __post_init__(self) -> None:
        most = len(self.modes.omega_rad_s)
        if len(self.chosen) > MODES or not all(1 <= number <= most for number in self.chosen):
            raise ValueError(f"chosen: {self.chosen} are not at most {MODES} of the modes 1 to {most}")
        if len(self.controls) != CONTROLS:
            raise ValueError(f"controls: {len(self.controls)} values; allowed: {CONTROLS}")

    @property
    def state_names(self) -> tuple[str, ...]:
        """Twelve rigid-body states, then η and its rates."""
        return state_names(len(self.modes.omega_rad_s))

    @property
    def state_units(self) -> tuple[str, ...]:
        """In the order of the states."""
        return state_units(len(self.modes.omega_rad_s))

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Where the doublet jumps."""
        return self.doublet.times_s if self.doublet else ()

    @property
    def work_size(self) -> int:
        """Features, coefficients, and the aerodynamics' own scratch."""
        return SCRATCH + self.aerodynamics.work_size + 1

    @property
    def kernel(self) -> FlexibleAircraft:
        """The constants of the equations of motion."""
        return _kernel(self)

    def energy(self, x: Array) -> Array:
        """Kinetic, potential (of height) and elastic energy [J] of states (..., d)."""
        k = len(self.modes.omega_rad_s)
        properties = self.modes.properties
        inertia = TO_BODY @ properties.inertia @ TO_BODY
        rates = x[..., RATES_IN_X]
        eta, eta_dot = x[..., RIGID_STATES : RIGID_STATES + k], x[..., RIGID_STATES + k :]
        kinetic = 0.5 * properties.mass * np.sum(x[..., VELOCITY_IN_X] ** 2, axis=-1)
        kinetic = kinetic + 0.5 * np.einsum("...i,ij,...j", rates, inertia, rates)
        elastic = 0.5 * np.sum(eta_dot**2 + (self.modes.omega_rad_s * eta) ** 2, axis=-1)
        return np.asarray(kinetic + elastic + properties.mass * self.gravity_m_s2 * x[..., ALTITUDE_M])

    def with_doublet(self, doublet: Doublet | None) -> "FlightModel":
        """The same aircraft with another pilot's input."""
        return replace(self, doublet=doublet)

    def with_aerodynamics(self, aerodynamics: CompiledMapping) -> "FlightModel":
        """The same aircraft with another aerodynamics in its place."""
        return replace(self, aerodynamics=aerodynamics)


def features(model: FlightModel, t: Array, x: Array) -> Array:
    """The 25 inputs (m, 25) of the aerodynamics along a trajectory: times (m,) and states (m, d)."""
    inputs = np.empty((len(t), len(FEATURES)))
    features_along(airless(model), np.ascontiguousarray(t), np.ascontiguousarray(x), inputs)
    return inputs


def airless(model: FlightModel) -> FlexibleAircraft:
    """The constants of `model` without its aerodynamics, for `features_along` and `motion_with`."""
    return _kernel(model)._replace(aerodynamics=())


def _kernel(model: FlightModel) -> FlexibleAircraft:
    modes, aircraft = model.modes, model.modes.model.aircraft
    properties = modes.properties
    inertia = TO_BODY @ properties.inertia @ TO_BODY
    nodes = modes.model.skeleton.nodes
    engines = list(modes.model.engines)
    shapes = modes.shapes.reshape(len(nodes), 6, -1)
    height = float(np.mean(nodes[engines, 2] - properties.centre_of_gravity[2]))
    places = np.full(MODES, -1.0)
    places[: len(model.chosen)] = np.array(model.chosen) - 1.0
    doublet = model.doublet or Doublet(np.zeros(CONTROLS), (0.0, 0.0, 0.0))
    return FlexibleAircraft(
        mass=float(properties.mass),
        gravity=float(model.gravity_m_s2),
        area=float(aircraft.reference.area_m2),
        chord=float(aircraft.reference.chord_m),
        span=float(aircraft.published.wing_span_m),
        inertia=inertia,
        inverse_inertia=_vector(np.linalg.inv(inertia)),
        omega_squared=modes.omega_rad_s**2,
        damping=2.0 * aircraft.structural_damping_ratio * modes.omega_rad_s,
        places=places,
        thrust=float(model.thrust_N),
        thrust_height=-height,  # downwards
        thrust_shape=-np.mean(shapes[engines, 0], axis=0),  # forwards
        controls=_vector(model.controls),
        command=_vector(doublet.command),
        times=_vector(doublet.times_s),
        aerodynamics=model.aerodynamics.kernel,
    )


def _vector(values: ArrayLike) -> Array:
    return np.array(values, dtype=np.float64)
