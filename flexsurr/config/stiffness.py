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
    axial_stiffness_N: Values
    flapwise_bending_stiffness_N_m2: Values
    edgewise_bending_stiffness_N_m2: Values
    torsional_stiffness_N_m2: Values

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
    flapwise_bending_stiffness_N_m2: Positive
    edgewise_bending_stiffness_N_m2: Positive
    torsional_stiffness_N_m2: Positive

    @property
    def value(self) -> tuple[float, float, float, float]:
        """(EA, EI flapwise, EI edgewise, GJ)."""
        ea, flapwise, edgewise, gj = (getattr(self, key) for key in STIFFNESSES)
        return ea, flapwise, edgewise, gj


class Connections(Record):
    """The elements between beams, and the pylon and nacelle, which have one or a few of their own."""

    source: Literal["published", "transcribed", "digitised", "assumed"]
    wing_to_fuselage: ConnectionStiffness
    horizontal_tail_to_fuselage: ConnectionStiffness
    vertical_tail_to_fuselage: ConnectionStiffness
    wing_to_pylon: ConnectionStiffness
    pylon: ConnectionStiffness
    nacelle: ConnectionStiffness
    pylon_to_nacelle_forward: ConnectionStiffness
    pylon_to_nacelle_aft: ConnectionStiffness


class Stiffness(Record):
    """All beams of the aircraft and their connections."""

    source: Literal["published", "transcribed", "digitised", "assumed"]
    wing_side_of_body_to_crank: BeamStiffness
    wing_crank_to_tip: BeamStiffness
    horizontal_tail: BeamStiffness
    vertical_tail: BeamStiffness
    fuselage: BeamStiffness
    connections: Connections
