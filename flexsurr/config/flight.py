"""How the airliner is flown: trim, manoeuvres, and the simulations that measure it (a study's `flight`)."""

from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from flexsurr.config.schema import Record, check_once
from flexsurr.config.structure import NotNegative, Positive
from flexsurr.config.study import Count, check_steps

Control = Literal["elevator", "aileron", "rudder"]
CONTROL_NAMES: tuple[Control, ...] = ("elevator", "aileron", "rudder")

Mach = Annotated[float, Field(gt=0.0, lt=0.95)]
Altitude = Annotated[float, Field(ge=0.0, le=20000.0)]
Range = tuple[float, float]


class TrimLimits(Record):
    """Where a trim may lie; beyond, none exists for this aircraft."""

    alpha_deg: Range = (-5.0, 10.0)
    """Angle of attack, positive nose up [°]."""
    incidence_deg: Range = (-12.0, 5.0)
    """Incidence of the horizontal tail, positive leading edge up [°]."""
    thrust_N: Range = (0.0, 120000.0)
    """Thrust of both engines together, positive forwards [N]."""

    @field_validator("*", mode="after")
    @classmethod
    def _ordered(cls, limits: Range) -> Range:
        if limits[0] >= limits[1]:
            raise ValueError(f"{limits[0]}, {limits[1]} are not allowed; allowed: the lower limit, the upper")
        return limits


class FlightCondition(Record):
    """Straight and level flight at a Mach number and an altitude of the standard atmosphere."""

    mach: Mach
    """Mach number; Prandtl–Glauert's rule ends below 0.95."""
    altitude_m: Altitude
    """Altitude in the standard atmosphere [m]."""


class DoubletTimes(Record):
    """When a control moves: to one side, to the other, and back."""

    start_s: NotNegative = 0.5
    """The control goes to its positive amplitude [s]."""
    middle_s: Positive = 1.5
    """It goes to the negative one [s]."""
    end_s: Positive = 2.5
    """It goes back [s], before the flight ends. The three increase."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.start_s < self.middle_s < self.end_s:
            raise ValueError(
                f"start_s, middle_s, end_s: {self.start_s}, {self.middle_s}, {self.end_s} are not allowed; "
                "allowed: increasing"
            )
        return self


class RandomFlights(Record):
    """Flights to compare costs and errors by, at random trims and amplitudes.

    Both are drawn from the limits of the network's training.
    """

    of_each_doublet: Count = 30
    """Flights with a doublet of each control."""
    least_deg: NotNegative = 1.0
    """Least amplitude [°]; smaller ones move too little to measure an error by. Below the limits of every
    control.
    """
    rebuild_flights: Count = 3
    """Of these, how many are flown with a lattice that is rebuilt at every call, the dearest baseline."""
    frozen_flights: Count = 6
    """Of these, on how many the lattice with frozen matrices is timed. All are flown with it, for errors."""
    repeats: Count = 3
    """How often each flight of a fast model is timed; the median counts."""
    seed: Annotated[int, Field(ge=0)] = 2024
    """Seed of the draws."""


class FlightSettings(Record):
    """Everything about the airliner's flights that is not the aircraft."""

    elastic_modes: Annotated[int, Field(ge=1, le=30)] = 8
    """Elastic modes of the aircraft that move in flight, from the lowest."""
    aerodynamic_modes: Annotated[tuple[Count, ...], Field(min_length=1, max_length=6)] = (1, 2, 5, 6, 7, 8)
    """Numbers of those that the aerodynamics feels: by default the paper's six. Each at most once."""
    condition: FlightCondition = FlightCondition(mach=0.7, altitude_m=10000.0)
    """Where the drawn manoeuvres begin."""
    envelope_mach: Annotated[tuple[Mach, ...], Field(min_length=1)] = (0.6, 0.65, 0.7, 0.75)
    """Mach numbers of the trims that are tabulated."""
    envelope_altitude_m: Annotated[tuple[Altitude, ...], Field(min_length=1)] = (8000.0, 9000.0, 10000.0)
    """Altitudes of the trims that are tabulated [m]."""
    limits: TrimLimits = TrimLimits()
    """Where a trim may lie."""
    step_s: Positive = 0.005
    """Step of RK4, and between samples [s]."""
    duration_s: Positive = 5.0
    """Length of each flight, a whole number of steps [s]."""
    doublet_deg: Annotated[float, Field(gt=0.0, le=30.0)] = 5.0
    """Amplitude of the drawn doublets [°]. Positive: trailing edge of the elevator down, of the left aileron
    down and the right one up, of the rudder to the left.
    """
    doublet: DoubletTimes = DoubletTimes()
    """When the control moves."""
    random_flights: RandomFlights = RandomFlights()
    """Flights by which costs and errors are compared."""

    @model_validator(mode="after")
    def _lasts_whole_steps(self) -> Self:
        check_steps(self.duration_s, self.step_s)
        return self

    @model_validator(mode="after")
    def _the_doublet_ends_in_time(self) -> Self:
        if not self.doublet.end_s < self.duration_s:
            raise ValueError(
                f"doublet.end_s: {self.doublet.end_s:g} is not allowed; allowed: less than duration_s: "
                f"{self.duration_s:g}"
            )
        return self

    @model_validator(mode="after")
    def _modes_are_there(self) -> Self:
        for number in self.aerodynamic_modes:
            if number > self.elastic_modes:
                raise ValueError(
                    f"aerodynamic_modes: mode {number} is not allowed; allowed: 1 to elastic_modes = "
                    f"{self.elastic_modes}"
                )
        check_once(self.aerodynamic_modes, "aerodynamic_modes: ")
        return self
