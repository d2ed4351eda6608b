"""Loads on the beam as data: where a force acts, and when (`evaluation.load` in config/studies/*.yaml).

A load of fixed shape follows one history: F(t) = factor(t) f. All forces are dead: they keep their direction,
which is given in the clamp's frame before the clamp is turned.
"""

from typing import Annotated, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from flexsurr.config.schema import Record, by_kind
from flexsurr.config.structure import NotNegative, Positive, Structure

Vector = tuple[float, float, float]
AXES: tuple[Vector, Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Interval(Record):
    """A load acts for start_s ≤ t < end_s."""

    start_s: NotNegative = 0.0
    """When the load begins to act [s]."""
    end_s: Positive | None = None
    """When it ends [s], after its start. None: it does not end by itself."""

    @model_validator(mode="after")
    def _ends_after_its_start(self) -> Self:
        if self.end_s is not None and not self.start_s < self.end_s:
            raise ValueError(f"a load must end after its start: start {self.start_s} s, end {self.end_s} s")
        return self


class Constant(Interval):
    """A factor of 1."""

    kind: Literal["constant"] = "constant"
    """Held as it is."""


class Sine(Interval):
    """The factor sin(ω t + phase)."""

    kind: Literal["sine"] = "sine"
    """Swinging."""
    frequency_rad_s: Positive
    """ω, the angular frequency [rad/s]."""
    phase_rad: float = 0.0
    """The phase at t = 0 [rad]."""


class Power(Interval):
    """A power of the time as factor: (t / reference_s)^exponent."""

    kind: Literal["power"] = "power"
    """Growing from t = 0."""
    exponent: Annotated[int, Field(ge=1)]
    """Power of (t / reference_s)."""
    reference_s: Positive = 1.0
    """The time at which the factor is 1 [s]."""


# Another history is one more record here, and its factor in flexsurr.simulation.history.
History = Annotated[
    Annotated[Constant, Tag("constant")] | Annotated[Sine, Tag("sine")] | Annotated[Power, Tag("power")],
    Discriminator(by_kind),
]


class _Load(Record):
    """What every load has."""

    history: History = Constant()
    """The factor that it follows in time. None given: held as it is."""

    def until(self, end_s: float) -> Self:
        """The same load that ends at `end_s` [s], if it does not end before."""
        own = self.history.end_s
        ends = {"end_s": end_s if own is None else min(own, end_s)}
        return self.model_copy(update={"history": self.history.model_copy(update=ends)})


class TipForce(_Load):
    """A force at the tip."""

    kind: Literal["tip_force"] = "tip_force"
    """All of it at the tip."""
    force_N: float
    """Its size [N], positive along `direction`."""
    direction: Vector = AXES[2]
    """Of any length but 0, in the clamp's frame before it is turned: x along the span, y left, z up. By
    default up.
    """

    @model_validator(mode="after")
    def _has_a_direction(self) -> Self:
        if not any(self.direction):
            raise ValueError(f"direction: {list(self.direction)} is the zero vector; allowed: any other")
        return self

    @property
    def directions(self) -> tuple[Vector, ...]:
        """Along which it pushes."""
        return (self.direction,) if self.force_N else ()


Shape = Literal["uniform", "linear", "elliptic", "one_minus_elliptic"]


class Spread(Record):
    """A force per length along the span: its size times a shape of ξ = x/L."""

    force_N_m: float
    """Force per span [N/m] where the shape is 1; positive along the axis."""
    shape: Shape = "uniform"
    """How it varies along ξ = x / L: 1; ξ; √(1 − ξ²), as lift in eq. 14; 1 − √(1 − ξ²), as drag in eq. 13."""


class DistributedForce(_Load):
    """Forces per length along the axes, each of its own shape."""

    kind: Literal["distributed"] = "distributed"
    """Along the span."""
    along_x: Spread | None = None
    """What acts along x, outwards. At least one of the three is given."""
    along_y: Spread | None = None
    """What acts along y, to the left."""
    along_z: Spread | None = None
    """What acts along z, upwards."""
    from_m: NotNegative = 0.0
    """Where it begins, from the clamp [m]."""
    to_m: Positive | None = None
    """Where it ends, from the clamp, within the span [m]. None: at the tip."""
    acts_on: Literal["span", "tip"] = "span"
    """span gives each element the integral over its own span, at its centre on the elastic axis; tip gives
    all of it to the tip.
    """

    @model_validator(mode="after")
    def _acts_along_an_axis(self) -> Self:
        if not any(self.spreads):
            raise ValueError("along_x, along_y, along_z: none is given; allowed: at least one")
        return self

    @property
    def spreads(self) -> tuple[Spread | None, ...]:
        """Along x, y and z."""
        return self.along_x, self.along_y, self.along_z

    @property
    def directions(self) -> tuple[Vector, ...]:
        """Along which it pushes."""
        spreads = zip(AXES, self.spreads, strict=True)
        return tuple(axis for axis, spread in spreads if spread is not None and spread.force_N_m)


Load = Annotated[
    Annotated[TipForce, Tag("tip_force")] | Annotated[DistributedForce, Tag("distributed")],
    Discriminator(by_kind),
]


def loaded_span(load: DistributedForce, span_m: float) -> tuple[float, float]:
    """Where the load begins and ends [m]; ValueError unless it lies within the span."""
    to_m = span_m if load.to_m is None else load.to_m
    if not 0.0 <= load.from_m < to_m <= span_m:
        raise ValueError(
            f"from_m, to_m: a load from {load.from_m:g} to {to_m:g} m does not lie within the span "
            f"(0 to {span_m:g} m)"
        )
    return load.from_m, to_m


def check_load(load: TipForce | DistributedForce, structure: Structure) -> None:
    """ValueError for a load outside the span, or one that no joint of the structure can feel."""
    if isinstance(load, DistributedForce):
        loaded_span(load, structure.length_m)
    for force in load.directions:
        for axis in structure.felt_axes:
            if abs(sum(f * a for f, a in zip(force, axis, strict=True))) > 1e-12 * sum(map(abs, force)):
                return
    joints = ", ".join(structure.ordered_joints)
    raise ValueError(f"no joint feels it; allowed: a force that can do work on the joints ({joints})")
