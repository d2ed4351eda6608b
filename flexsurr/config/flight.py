"""How the airliner is flown: trim, manoeuvres, and the simulations it is judged by (a study's `flight`)."""

from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from flexsurr.config.schema import Record
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
    incidence_deg: Range = (-12.0, 5.0)
    thrust_N: Range = (0.0, 120000.0)

    @field_validator("*", mode="after")
    @classmethod
    def _ordered(cls, limits: Range) -> Range:
        if limits[0] >= limits[1]:
            raise ValueError(f"the lower limit {limits[0]} is not below the upper one {limits[1]}")
        return limits


class FlightCondition(Record):
    """Straight and level flight at a Mach number and an altitude of the standard atmosphere."""

    mach: Mach
    altitude_m: Altitude


class DoubletTimes(Record):
    """A control goes up at `start_s`, down at `middle_s`, back at `end_s`."""

    start_s: NotNegative = 0.5
    middle_s: Positive = 1.5
    end_s: Positive = 2.5

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.start_s < self.middle_s < self.end_s:
            raise ValueError(
                f"start_s, middle_s, end_s: {self.start_s}, {self.middle_s}, {self.end_s} are not increasing"
            )
        return self


class RandomFlights(Record):
    """Flights to compare costs and errors by: each doublet so often, at random trims and amplitudes.

    Conditions and amplitudes are drawn from the limits of the network's training; amplitudes of less than
    `least_deg` are not, for what they move is little.
    """

    of_each_doublet: Count = 30
    least_deg: NotNegative = 1.0
    rebuild_flights: Count = 3
    repeats: Count = 3
    seed: Annotated[int, Field(ge=0)] = 2024


class FlightSettings(Record):
    """Everything about the airliner's flights that is not the aircraft."""

    elastic_modes: Annotated[int, Field(ge=1, le=30)] = 8
    aerodynamic_modes: Annotated[tuple[Count, ...], Field(min_length=1, max_length=6)] = (1, 2, 5, 6, 7, 8)
    condition: FlightCondition = FlightCondition(mach=0.7, altitude_m=10000.0)
    envelope_mach: Annotated[tuple[Mach, ...], Field(min_length=1)] = (0.6, 0.65, 0.7, 0.75)
    envelope_altitude_m: Annotated[tuple[Altitude, ...], Field(min_length=1)] = (8000.0, 9000.0, 10000.0)
    limits: TrimLimits = TrimLimits()
    step_s: Positive = 0.005
    duration_s: Positive = 5.0
    doublet_deg: Annotated[float, Field(gt=0.0, le=30.0)] = 5.0
    doublet: DoubletTimes = DoubletTimes()
    random_flights: RandomFlights = RandomFlights()

    @model_validator(mode="after")
    def _lasts_whole_steps(self) -> Self:
        check_steps(self.duration_s, self.step_s)
        return self

    @model_validator(mode="after")
    def _modes_are_there(self) -> Self:
        for number in self.aerodynamic_modes:
            if number > self.elastic_modes:
                raise ValueError(
                    f"aerodynamic_modes: mode {number} is not allowed; allowed: 1 to elastic_modes = "
                    f"{self.elastic_modes}"
                )
        if len(set(self.aerodynamic_modes)) != len(self.aerodynamic_modes):
            raise ValueError("aerodynamic_modes: each mode at most once")
        return self
