"""Stiffness of an aircraft's beams: one value for each element, from the root (or the nose) outwards."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.schema import Record
from flexsurr.config.structure import Positive

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
