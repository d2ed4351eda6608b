"""Structure of an aircraft: stiffness by element, from the root or the nose outwards; mass by parts."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.schema import Record
from flexsurr.config.structure import NotNegative, Positive

Values = tuple[Positive, ...]
STIFFNESSES = (
    "axial_stiffness_N",
    "flapwise_bending_stiffness_N_m2",
    "edgewise_bending_stiffness_N_m2",
    "torsional_stiffness_N_m2",
)


class BeamStiffness(Record):
    """Elements of equal length along a beam and EA, EI and GJ of each.

    Flapwise bending moves a beam across its surface, edgewise bending within it.
    """

    elements: Annotated[int, Field(ge=1)]
    """Number of them, of equal length."""
    axial_stiffness_N: Values
    """EA [N] of each element."""
    flapwise_bending_stiffness_N_m2: Values
    """EI across the surface [N m²] of each element."""
    edgewise_bending_stiffness_N_m2: Values
    """EI within the surface [N m²] of each element."""
    torsional_stiffness_N_m2: Values
    """GJ [N m²] of each element."""

    @model_validator(mode="after")
    def _a_value_for_each_element(self) -> Self:
        for key in STIFFNESSES:
            count = len(getattr(self, key))
            if count != self.elements:
                raise ValueError(f"{key}: {count} values; allowed: {self.elements}, one for each element")
        return self

    @property
    def values(self) -> tuple[tuple[float, float, float, float], ...]:
        """(EA, EI flapwise, EI edgewise, GJ) of each element."""
        return tuple(zip(*(getattr(self, key) for key in STIFFNESSES), strict=True))


class ConnectionStiffness(Record):
    """EA, EI and GJ of a single element that joins two beams."""

    axial_stiffness_N: Positive
    """EA [N]."""
    flapwise_bending_stiffness_N_m2: Positive
    """EI across the surface [N m²]."""
    edgewise_bending_stiffness_N_m2: Positive
    """EI within the surface [N m²]."""
    torsional_stiffness_N_m2: Positive
    """GJ [N m²]."""

    @property
    def value(self) -> tuple[float, float, float, float]:
        """(EA, EI flapwise, EI edgewise, GJ)."""
        ea, flapwise, edgewise, gj = (getattr(self, key) for key in STIFFNESSES)
        return ea, flapwise, edgewise, gj


class Connections(Record):
    """The elements between beams, and the pylon and nacelle, which have one or a few of their own."""

    source: Literal["published", "transcribed", "digitised", "assumed"]
    """Where its numbers come from: the paper of the study, another's tables, another's plots, or nowhere in
    public.
    """
    wing_to_fuselage: ConnectionStiffness
    """On either side."""
    horizontal_tail_to_fuselage: ConnectionStiffness
    """On either side."""
    vertical_tail_to_fuselage: ConnectionStiffness
    """At its root."""
    wing_to_pylon: ConnectionStiffness
    """From the elastic axis down."""
    pylon: ConnectionStiffness
    """Forward along it."""
    nacelle: ConnectionStiffness
    """From hanger to hanger."""
    pylon_to_nacelle_forward: ConnectionStiffness
    """The forward hanger."""
    pylon_to_nacelle_aft: ConnectionStiffness
    """The aft hanger."""


class Stiffness(Record):
    """All beams of the aircraft and their connections."""

    source: Literal["published", "transcribed", "digitised", "assumed"]
    """Where its numbers come from: the paper of the study, another's tables, another's plots, or nowhere in
    public.
    """
    wing_side_of_body_to_crank: BeamStiffness
    """The wing's first section that has a beam."""
    wing_crank_to_tip: BeamStiffness
    """The wing's last section."""
    horizontal_tail: BeamStiffness
    """Each half."""
    vertical_tail: BeamStiffness
    """All of it."""
    fuselage: BeamStiffness
    """From nose to tail."""
    connections: Connections
    """What joins the beams."""


Fraction = Annotated[float, Field(gt=0.0, le=1.0)]


class Engine(Record):
    """Each of two engines, a point mass that is a cylinder in its moments of inertia.

    The pylon runs forward, below the wing's elastic axis, to the two hangers that carry the nacelle.
    """

    mass_kg: Positive
    """Mass of each [kg]."""
    y_m: Positive
    """How far to the side of the plane of symmetry [m]."""
    ahead_of_elastic_axis_m: float
    """Ahead of the wing's elastic axis there [m]."""
    below_elastic_axis_m: float
    """Below it, below the pylon too [m]."""
    length_m: Positive
    """Length of the cylinder [m]."""
    diameter_m: Positive
    """Diameter of the cylinder [m]."""
    pylon_below_elastic_axis_m: Positive
    """How far the pylon runs below the elastic axis [m]."""
    hangers_ahead_of_elastic_axis_m: tuple[Positive, Positive]
    """Forward and aft hanger, ahead of the elastic axis and on both sides of the engine's centre [m]."""

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
    """Its mass [kg]."""
    x_m: Positive
    """Aft of the nose [m]."""


class SpreadMass(Record):
    """A mass spread evenly over a length of the fuselage, with a radius of gyration in roll."""

    mass_kg: Positive
    """Its mass [kg]."""
    x_m: tuple[float, float]
    """From where to where, aft of the nose [m]."""
    radius_of_gyration_m: NotNegative
    """In roll, about its own axis [m]."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.x_m[0] >= self.x_m[1]:
            raise ValueError(f"x_m: begins at {self.x_m[0]}, not before its end {self.x_m[1]}")
        return self


class CentredMass(Record):
    """A mass in the shell of the whole fuselage, spread as x^(a−1) (L−x)^(b−1) from the nose."""

    mass_kg: Positive
    """Its mass [kg]."""
    centroid_x_m: Positive
    """Aft of the nose [m]; b follows from it."""
    taper: Annotated[float, Field(ge=1.0)]
    """a: 1 does not thin out at the nose."""


class Masses(Record):
    """Everything the aircraft weighs."""

    source: Literal["published", "transcribed", "digitised", "assumed"]
    """Where its numbers come from: the paper of the study, another's tables, another's plots, or nowhere in
    public.
    """
    wing_structure_kg: Positive
    """Mass of both halves, spread as the chord squared [kg]."""
    fuel_kg: Positive
    """Mass of the fuel in both halves, spread likewise [kg]."""
    fuel_to_semi_span: Fraction
    """Fraction of the semi-span that the fuel reaches to."""
    engine: Engine
    """Each of two."""
    horizontal_tail_kg: Positive
    """Mass of both halves, spread as the chord squared [kg]."""
    vertical_tail_kg: Positive
    """Its mass, spread likewise [kg]."""
    main_gear: PointMass
    """On the fuselage's axis."""
    nose_gear: PointMass
    """On the fuselage's axis."""
    payload: SpreadMass
    """In the fuselage."""
    fuselage_and_systems: CentredMass
    """All the rest."""
    section_centre_of_gravity: Fraction
    """Of sections of wing and tails, as a fraction of the chord from the leading edge."""
    section_radius_of_gyration: Fraction
    """Of these sections, over the chord."""

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
