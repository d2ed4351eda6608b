"""Mass of an aircraft by parts, and how each is spread."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.schema import Record
from flexsurr.config.structure import NotNegative, Positive

Fraction = Annotated[float, Field(gt=0.0, le=1.0)]


class Engine(Record):
    """Each of two engines, a point mass that is a cylinder in its moments of inertia.

    `y_m` is its place to the side; it sits ahead of the wing's elastic axis there and below it. The pylon
    runs forward, below the elastic axis, to the two hangers that carry the nacelle.
    """

    mass_kg: Positive
    y_m: Positive
    ahead_of_elastic_axis_m: float
    below_elastic_axis_m: float
    length_m: Positive
    diameter_m: Positive
    pylon_below_elastic_axis_m: Positive
    hangers_ahead_of_elastic_axis_m: tuple[Positive, Positive]

    @model_validator(mode="after")
    def _hangs_between_its_hangers(self) -> Self:
        forward, aft = self.hangers_ahead_of_elastic_axis_m
        if not forward > self.ahead_of_elastic_axis_m > aft:
            raise ValueError(
                f"hangers_ahead_of_elastic_axis_m: [{forward}, {aft}] do not lie on both sides of the engine "
                f"at {self.ahead_of_elastic_axis_m}"
            )
        if self.below_elastic_axis_m <= self.pylon_below_elastic_axis_m:
            raise ValueError(
                f"pylon_below_elastic_axis_m: {self.pylon_below_elastic_axis_m} is not above the engine at "
                f"{self.below_elastic_axis_m}"
            )
        return self


class PointMass(Record):
    """A mass on the axis of the fuselage."""

    mass_kg: Positive
    x_m: Positive


class SpreadMass(Record):
    """A mass spread evenly over a length of the fuselage, with a radius of gyration in roll."""

    mass_kg: Positive
    x_m: tuple[float, float]
    radius_of_gyration_m: NotNegative

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.x_m[0] >= self.x_m[1]:
            raise ValueError(f"x_m: begins at {self.x_m[0]}, not before its end {self.x_m[1]}")
        return self


class CentredMass(Record):
    """A mass in the shell of the whole fuselage, as x^(a−1) (L−x)^(b−1).

    `taper` is a, from 1 (does not thin out at the nose); b puts the centroid at `centroid_x_m`.
    """

    mass_kg: Positive
    centroid_x_m: Positive
    taper: Annotated[float, Field(ge=1.0)]


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
