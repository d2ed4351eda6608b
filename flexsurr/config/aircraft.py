"""The aircraft: geometry, stiffness and mass of a transport with a tail (config/aircraft/*.yaml).

Axes of the file: x aft from the nose, y to the right, z up. Every block says where its numbers come from.
"""

import math
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from flexsurr.config.aircraft_structure import Masses, Stiffness
from flexsurr.config.reading import Source as FileOfValues
from flexsurr.config.reading import build, read_yaml
from flexsurr.config.schema import Record
from flexsurr.config.structure import NotNegative, Positive

Source = Literal["published", "transcribed", "digitised", "assumed"]
Fraction = Annotated[float, Field(ge=0.0, le=1.0)]
Point = tuple[float, float, float]
Angle = Annotated[float, Field(gt=-90.0, lt=90.0)]

SURFACES = ("wing", "horizontal_tail", "vertical_tail")
TWO_SIDED = ("wing", "horizontal_tail")

# Parts must add up to the published mass to within this; they are given in whole kilograms.
_MASS_TOLERANCE_KG = 0.5
_SPAN_TOLERANCE_M = 0.01
_SAME_STATION = 1e-9  # of the span


class Published(Record):
    """What the paper of the study says of the aircraft; the model is held against it."""

    source: Source
    """Where its numbers come from: the paper of the study, another's tables, another's plots, or nowhere in
    public.
    """
    wing_span_m: Positive
    """From tip to tip [m]; the sections of the wing add up to it."""
    fuselage_length_m: Positive
    """From nose to tail [m]."""
    mass_kg: Positive
    """Mass of everything [kg]; the parts under mass add up to it."""


class Reference(Record):
    """Reference quantities of the coefficients; the span is the published one."""

    source: Source
    """Where its numbers come from: the paper of the study, another's tables, another's plots, or nowhere in
    public.
    """
    area_m2: Positive
    """S, by which forces are divided [m²]."""
    chord_m: Positive
    """c, by which the pitching moment is divided [m]."""


class Section(Record):
    """A trapezoid of a lifting surface."""

    length_m: Positive
    """Along the surface, in the plane that its dihedral turns [m]."""
    chord_m: tuple[Positive, Positive]
    """Chord at its inner and outer end [m]; the outer is the inner one of the next section."""
    sweep_deg: Angle
    """Sweep of the leading edge, positive aft [°]."""
    dihedral_deg: Angle = 0.0
    """Dihedral, positive upwards [°]."""
    twist_deg: tuple[Angle, Angle] = (0.0, 0.0)
    """Added to the incidence, at its inner and outer end, positive leading edge up [°]."""


class Surface(Record):
    """A lifting surface: trapezoids from the root outwards, and the line its beam follows."""

    source: Source
    """Where its numbers come from: the paper of the study, another's tables, another's plots, or nowhere in
    public.
    """
    root_m: Point
    """x, y and z of the leading edge of the first section [m]."""
    incidence_deg: Angle = 0.0
    """Incidence of all of it, positive leading edge up [°]."""
    sections: Annotated[tuple[Section, ...], Field(min_length=1)]
    """From the root outwards."""
    elastic_axis: Annotated[tuple[Fraction, ...], Field(min_length=1)]
    """Its beam's place as a fraction of the chord: one value for all of it, or one at the beam's start and
    one at the outer end of each section from there on, linear in between.
    """
    beam_starts_at_m: NotNegative = 0.0
    """y of the beam's first node; on the vertical tail its height above the root [m]."""

    @model_validator(mode="after")
    def _chords_meet(self) -> Self:
        for i, (inner, outer) in enumerate(zip(self.sections, self.sections[1:], strict=False), start=1):
            if inner.chord_m[1] != outer.chord_m[0]:
                raise ValueError(
                    f"sections[{i}].chord_m: begins with {outer.chord_m[0]}, where the section "
                    f"before ends with {inner.chord_m[1]}"
                )
        return self

    def section_ends(self, vertical: bool = False) -> tuple[float, ...]:
        """Span coordinates [m] where its sections end: y, or height above the root where it is `vertical`."""
        steps = (section.length_m * math.cos(math.radians(section.dihedral_deg)) for section in self.sections)
        return tuple(accumulate(steps, initial=0.0 if vertical else self.root_m[1]))[1:]


class Surfaces(Record):
    """Wing and tails; the wing and the horizontal tail have a left side that mirrors the right."""

    wing: Surface
    """The right half; the left mirrors it."""
    horizontal_tail: Surface
    """The right half; the left mirrors it."""
    vertical_tail: Surface
    """Upwards from its root."""

    @model_validator(mode="after")
    def _beams_have_axes(self) -> Self:
        for name in SURFACES:
            surface: Surface = getattr(self, name)
            ends = surface.section_ends(vertical=name not in TWO_SIDED)
            start, given = surface.beam_starts_at_m, len(surface.elastic_axis)
            crossed = sum(end > start for end in ends)
            if crossed == 0:
                raise ValueError(
                    f"{name}.beam_starts_at_m: {start:g} is not allowed; allowed: up to {ends[-1]:g}"
                )
            if given not in (1, crossed + 1):
                raise ValueError(
                    f"{name}.elastic_axis: {given} values; allowed: one, or {crossed + 1}, one at the beam's "
                    "start and one at the end of each section from there on"
                )
        return self


class ControlSurface(Record):
    """A flap behind a hinge."""

    surface: str
    """What it is part of: wing, horizontal_tail or vertical_tail; one control surface on each."""
    hinge: Annotated[float, Field(ge=0.0, lt=1.0)]
    """Fraction of the chord ahead of the hinge."""
    span: tuple[Fraction, Fraction]
    """Where it begins and ends, as fractions of the semi-span."""

    @field_validator("surface")
    @classmethod
    def _is_there(cls, surface: str) -> str:
        if surface not in SURFACES:
            raise ValueError(f"no such surface; allowed: {', '.join(SURFACES)}")
        return surface

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.span[0] >= self.span[1]:
            raise ValueError(f"span: begins at {self.span[0]}, not before its end {self.span[1]}")
        return self


class ControlSurfaces(Record):
    """Elevator and aileron (a left and a right one each), rudder, and the surface i_t turns as a whole."""

    source: Source
    """Where its numbers come from: the paper of the study, another's tables, another's plots, or nowhere in
    public.
    """
    elevator: ControlSurface
    """A left and a right half."""
    aileron: ControlSurface
    """A left and a right one."""
    rudder: ControlSurface
    """One."""
    trimmed_surface: Literal["horizontal_tail"]
    """What turns as a whole to trim."""

    @model_validator(mode="after")
    def _one_on_each_surface(self) -> Self:
        owners: dict[str, str] = {}
        for name in ("elevator", "aileron", "rudder"):
            surface = getattr(self, name).surface
            if surface in owners:
                raise ValueError(
                    f"{name}.surface: {surface} has the {owners[surface]} already; "
                    "allowed: one control surface each"
                )
            owners[surface] = name
        return self

    @field_validator("elevator", "aileron")
    @classmethod
    def _has_two_sides(cls, control: ControlSurface, info: ValidationInfo) -> ControlSurface:
        if control.surface not in TWO_SIDED:
            raise ValueError(
                f"{info.field_name} has a left and a right half, {control.surface} has not; "
                f"allowed: surface {' or '.join(TWO_SIDED)}"
            )
        return control


class Fuselage(Record):
    """A body of revolution about a straight line, for its beam and for the moment of its flow (Munk)."""

    source: Source
    """Where its numbers come from: the paper of the study, another's tables, another's plots, or nowhere in
    public.
    """
    diameter_m: Positive
    """Diameter of the cylinder about it [m]."""
    axis_z_m: float
    """Height of its axis, positive up [m]."""
    fullness: Annotated[float, Field(gt=0.0, le=1.0)]
    """Its volume over that of the cylinder about it."""


class Aerodynamics(Record):
    """What the lattice does not know."""

    source: Source
    """Where its numbers come from: the paper of the study, another's tables, another's plots, or nowhere in
    public.
    """
    parasite_drag_coefficient: NotNegative
    """Drag without lift over q̄ S, at Mach 0.7 and 10 km; elsewhere it follows the skin friction of a plate.
    """


class Aircraft(Record):
    """An aircraft, with everything its stick model, its lattice and its flight need."""

    name: str
    """What results and errors call it."""
    published: Published
    """What the model is held against."""
    reference: Reference
    """Of the coefficients."""
    surfaces: Surfaces
    """Wing and tails."""
    control_surfaces: ControlSurfaces
    """What the pilot moves."""
    fuselage: Fuselage
    """The body."""
    stiffness: Stiffness
    """Of its beams."""
    mass: Masses
    """Of its parts."""
    aerodynamics: Aerodynamics
    """What the lattice does not know."""
    structural_damping_ratio: Annotated[float, Field(ge=0.0, lt=1.0)]
    """Damping of every elastic mode over the critical damping."""

    @model_validator(mode="after")
    def _agrees_with_itself(self) -> Self:
        half = self.surfaces.wing.section_ends()[-1]
        if abs(2.0 * half - self.published.wing_span_m) > _SPAN_TOLERANCE_M:
            raise ValueError(
                f"surfaces.wing.sections: span {2.0 * half:.6g} m, published.wing_span_m is "
                f"{self.published.wing_span_m:.6g}"
            )
        last = max(
            self.mass.payload.x_m[1], self.mass.main_gear.x_m, self.mass.fuselage_and_systems.centroid_x_m
        )
        if last > self.published.fuselage_length_m:
            raise ValueError(
                f"mass: a part lies at x = {last:.6g} m, behind the fuselage, which is "
                f"{self.published.fuselage_length_m} m long"
            )
        total = self.mass.total_kg
        if abs(total - self.published.mass_kg) > _MASS_TOLERANCE_KG:
            raise ValueError(
                f"mass: the parts add up to {total:.10g} kg, published.mass_kg is "
                f"{self.published.mass_kg:.10g}"
            )
        return self

    def parts_of_span(self, name: str) -> int:
        """How many parts sections and control surfaces make of the span of a surface: its least strips."""
        surface: Surface = getattr(self.surfaces, name)
        vertical = name not in TWO_SIDED
        tip = surface.section_ends(vertical)[-1]
        root = 0.0 if vertical else surface.root_m[1] / tip
        controls = (
            self.control_surfaces.elevator,
            self.control_surfaces.aileron,
            self.control_surfaces.rudder,
        )
        flaps = [max(edge, root) for control in controls if control.surface == name for edge in control.span]
        edges = sorted([root, *(end / tip for end in surface.section_ends(vertical)), *flaps])
        return sum(after - before > _SAME_STATION for before, after in pairwise(edges))


def load_aircraft(path: Path, shown: str | None = None) -> Aircraft:
    """The aircraft of the YAML file at `path`, named `shown` in errors.

    Raises ConfigurationError with one line a mistake: file, key, value and what is allowed.
    """
    name = shown or str(path)
    return build(Aircraft, [FileOfValues(name, read_yaml(path, name))])
