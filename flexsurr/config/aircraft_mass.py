"""Mass of an aircraft by parts, and how each is spread."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.schema import Record
from flexsurr.config.structure import Positive

Fraction = Annotated[float, Field(gt=0.0, le=1.0)]


class Engine(Record):
    """Each of two engines, a point mass that is a cylinder in its moments of inertia.

    `y_m` is its place to the side; it sits ahead of the wing's elastic axis there and below it.
    """

    mass_kg: Positive
    y_m: Positive
    ahead_of_elastic_axis_m: float
    below_elastic_axis_m: float
    length_m: Positive
    diameter_m: Positive


class PointMass(Record):
    """A mass on the axis of the fuselage."""

    mass_kg: Positive
    x_m: Positive


class SpreadMass(Record):
    """A mass spread evenly over a length of the fuselage."""

    mass_kg: Positive
    x_m: tuple[float, float]

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.x_m[0] >= self.x_m[1]:
            raise ValueError(f"x_m: begins at {self.x_m[0]}, not before its end {self.x_m[1]}")
        return self


class CentredMass(Record):
    """A mass spread over the whole fuselage, linearly, so that its centroid lies at `centroid_x_m`."""

    mass_kg: Positive
    centroid_x_m: Positive


class Masses(Record):
    """Everything the aircraft weighs.

    Wing and tails are spread as their chord squared; fuel as the wing's out to `fuel_to_semi_span`.
    The centre of gravity of a section of wing or tail and its radius of gyration are fractions of the chord.
    """

    source: Literal["published", "transcribed", "digitised", "assumed"]
    wing_structure_kg: Positive
    fuel_kg: Positive
    fuel_to_semi_span: Fraction
    engine: Engine
    horizontal_tail_kg: Positive
    vertical_tail_kg: Positive
    main_gear: PointMass
    nose_gear: PointMass
    payload: SpreadMass
    fuselage_and_systems: CentredMass
    section_centre_of_gravity: Fraction
    section_radius_of_gyration: Fraction

    @property
    def total_kg(self) -> float:
        """Sum of all parts, both engines included."""
        return (
            self.wing_structure_kg
            + self.fuel_kg
            + 2.0 * self.engine.mass_kg
            + self.horizontal_tail_kg
            + self.vertical_tail_kg
            + self.main_gear.mass_kg
            + self.nose_gear.mass_kg
            + self.payload.mass_kg
            + self.fuselage_and_systems.mass_kg
        )
