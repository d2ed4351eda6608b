"""Loads on the beam as data: what acts where, and when (`evaluation.load` in config/studies/*.yaml).

A load of fixed shape follows one history: F(t) = factor(t) f. A dead load keeps its direction, which is
given in the clamp's frame before the clamp is turned: x along the undeformed span, y left, z up. A load that
`follows` turns with the element on which it acts, and its direction is given in that element's own axes.
"""

from abc import abstractmethod
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from flexsurr.config.history import Constant, History, with_table
from flexsurr.config.schema import Record, by_kind
from flexsurr.config.structure import Joint, NotNegative, Positive, Structure

Vector = tuple[float, float, float]
"""Along x, y and z."""
AXES: tuple[Vector, Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

TURNS_ABOUT: dict[Joint, int] = {"torsion": 0, "out_of_plane": 1, "in_plane": 2}
"""The axis, of x, y and z, about which a joint turns."""

_ROUNDING = 1e-12


class _Load(Record):
    """What every load has."""

    history: History = Constant()
    """The factor that it follows in time. None given: held as it is."""

    @property
    def parts(self) -> tuple["Single", ...]:
        """The loads of one history each that it is made of: itself."""
        return (self,)  # type: ignore[return-value]  # every subclass but `Several` is one of `Single`

    @property
    def start_s(self) -> float:
        """When it begins to act [s]."""
        return self.history.start_s

    def until(self, end_s: float) -> Self:
        """The same load that ends at `end_s` [s], if it does not end before."""
        own = self.history.end_s
        ends = {"end_s": end_s if own is None else min(own, end_s)}
        return self.model_copy(update={"history": self.history.model_copy(update=ends)})

    def with_tables(self, root: Path) -> Self:
        """The same load with the numbers of the file of its history, if any; ValueError as `with_table`."""
        return self.model_copy(update={"history": with_table(self.history, root)})

    def check(self, structure: Structure) -> None:
        """ValueError for a load that the structure cannot feel, or outside its span."""
        if not self._felt(structure):
            joints = ", ".join(structure.ordered_joints)
            raise ValueError(f"no joint feels it; allowed: a load that can do work on the joints ({joints})")

    @abstractmethod
    def _felt(self, structure: Structure) -> bool:
        """Whether it does work on any joint."""


class _Directed(_Load):
    """What every load along one direction has; the field stands with its meaning in each."""

    @model_validator(mode="after")
    def _has_a_direction(self) -> Self:
        direction: Vector = self.direction  # type: ignore[attr-defined]  # a field of each subclass
        if not any(direction):
            raise ValueError(f"direction: {list(direction)} is the zero vector; allowed: any other")
        return self


class _AtTheTip(_Directed):
    """What every load at the tip has."""

    follows: bool = False
    """Whether it turns with the last element. false: it is dead."""


class TipForce(_AtTheTip):
    """A force at the tip."""

    kind: Literal["tip_force"] = "tip_force"
    """All of it at the tip."""
    force_N: float
    """Its size [N], positive along `direction`."""
    direction: Vector = AXES[2]
    """Of any length but 0, in the clamp's frame before it is turned: x along the span, y left, z up. If it
    `follows`, in the last element's own axes. By default up.
    """

    def _felt(self, structure: Structure) -> bool:
        return bool(self.force_N) and _is_felt(structure, [self.direction], self.follows)


class TipMoment(_AtTheTip):
    """A moment at the tip."""

    kind: Literal["tip_moment"] = "tip_moment"
    """All of it on the last element."""
    moment_N_m: float
    """Its size [N m], positive about `direction` by the right hand."""
    direction: Vector = (0.0, -1.0, 0.0)
    """The axis about which it turns, of any length but 0, in the frame of a force's. By default −y: it lifts
    the tip.
    """

    def _felt(self, structure: Structure) -> bool:
        return bool(self.moment_N_m) and _turns(structure, [self.direction], self.follows)


Shape = Literal["uniform", "linear", "elliptic", "one_minus_elliptic"]


class Spread(Record):
    """A force per length along the span: its size times a shape of ξ = x/L."""

    force_N_m: float
    """Force per span [N/m] where the shape is 1; positive along the axis."""
    shape: Shape = "uniform"
    """How it varies along ξ = x / L: 1; ξ; √(1 − ξ²), as lift in eq. 14; 1 − √(1 − ξ²), as drag in eq. 13."""

    @property
    def size(self) -> float:
        """Where the shape is 1 [N/m]."""
        return self.force_N_m


class MomentSpread(Record):
    """A moment per length along the span: its size times a shape of ξ = x/L."""

    moment_N_m_m: float
    """Moment per span [N m/m] where the shape is 1; positive about the axis by the right hand."""
    shape: Shape = "uniform"
    """How it varies along ξ = x / L, as that of a force."""

    @property
    def size(self) -> float:
        """Where the shape is 1 [N m/m]."""
        return self.moment_N_m_m


class _AlongTheSpan(_Load):
    """What every distributed load has."""

    from_m: NotNegative = 0.0
    """Where it begins, from the clamp [m]."""
    to_m: Positive | None = None
    """Where it ends, from the clamp, within the span [m]. None: at the tip."""
    follows: bool = False
    """Whether it turns with each element; the axes are then the element's own. false: it is dead."""

    def check(self, structure: Structure) -> None:
        """ValueError for a load that the structure cannot feel, or outside its span."""
        loaded_span(self, structure.length_m)
        super().check(structure)


class DistributedForce(_AlongTheSpan):
    """Forces per length along the axes, each of its own shape."""

    kind: Literal["distributed"] = "distributed"
    """Along the span."""
    along_x: Spread | None = None
    """What acts along x, outwards. At least one of the three is given."""
    along_y: Spread | None = None
    """What acts along y, to the left."""
    along_z: Spread | None = None
    """What acts along z, upwards."""
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

    def _felt(self, structure: Structure) -> bool:
        return _is_felt(structure, _axes_of(self.spreads), self.follows)


class DistributedMoment(_AlongTheSpan):
    """Moments per length about the axes, each of its own shape."""

    kind: Literal["distributed_moment"] = "distributed_moment"
    """Along the span, on each element what acts within its own."""
    about_x: MomentSpread | None = None
    """What turns about x, the span. At least one of the three is given."""
    about_y: MomentSpread | None = None
    """What turns about y: where it is negative it lifts the tip."""
    about_z: MomentSpread | None = None
    """What turns about z, to the left."""

    @model_validator(mode="after")
    def _acts_about_an_axis(self) -> Self:
        if not any(self.spreads):
            raise ValueError("about_x, about_y, about_z: none is given; allowed: at least one")
        return self

    @property
    def spreads(self) -> tuple[MomentSpread | None, ...]:
        """About x, y and z."""
        return self.about_x, self.about_y, self.about_z

    def _felt(self, structure: Structure) -> bool:
        return _turns(structure, _axes_of(self.spreads), self.follows)


class ClampAcceleration(_Directed):
    """The clamp is moved without turning: a = factor(t) times this acceleration.

    Seen from the clamp each mass feels −m a. Positions, velocities and energies of the structure stay those
    that are seen from the clamp.
    """

    kind: Literal["clamp_acceleration"] = "clamp_acceleration"
    """The clamp is shaken."""
    acceleration_m_s2: float
    """Its size [m/s²], positive along `direction`."""
    direction: Vector = AXES[2]
    """Of any length but 0, in the clamp's frame before it is turned. By default up."""

    def _felt(self, structure: Structure) -> bool:
        twists = "torsion" in structure.joints and not _on_axis(structure)
        return bool(self.acceleration_m_s2) and (
            twists or _is_felt(structure, [self.direction], follows=False)
        )


Pushing = TipForce | TipMoment | DistributedForce | DistributedMoment | ClampAcceleration
"""What exerts the same forces, but for its history, whatever the velocities."""


class ClampRotation(_Directed):
    """The clamp turns about an axis fixed in space, at ω = factor(t) times this rate, from angle 0.

    Seen from the clamp each mass feels −m (ω̇ × r + ω × (ω × r) + 2 ω × v) at r from the axis, and gravity
    turns. Positions, velocities and energies of the structure stay those that are seen from the clamp, and
    other loads turn with it. The rate may begin at t = 0 with any value, as of a rotor that is turning; it
    must not jump later. A forced response that ends its load early leaves the clamp turning.
    """

    kind: Literal["clamp_rotation"] = "clamp_rotation"
    """The clamp is turned."""
    rate_rad_s: float
    """Its rate [rad/s] at a factor of 1, positive about `direction` by the right hand. A clamp that swings by
    an angle a, a sin(ω t), turns at the rate a ω with a sine of ω as history, phase π/2.
    """
    direction: Vector = AXES[2]
    """The axis, of any length but 0, in the clamp's frame before it is turned. By default up."""
    arm_m: Vector = (0.0, 0.0, 0.0)
    """From a point of the axis to the clamp [m], along x, y and z of the clamp's frame before it is turned:
    [0.3, 0, 0] for a blade on a hub of 0.3 m.
    """

    def until(self, end_s: float) -> Self:
        """The same: a clamp does not stop at once."""
        return self

    def _felt(self, structure: Structure) -> bool:
        return bool(self.rate_rad_s)


Single = Pushing | ClampRotation
"""A load that follows one history."""

_EachSingle = (
    Annotated[TipForce, Tag("tip_force")]
    | Annotated[TipMoment, Tag("tip_moment")]
    | Annotated[DistributedForce, Tag("distributed")]
    | Annotated[DistributedMoment, Tag("distributed_moment")]
    | Annotated[ClampAcceleration, Tag("clamp_acceleration")]
    | Annotated[ClampRotation, Tag("clamp_rotation")]
)


class SeveralLoads(Record):
    """Loads that act at once, each with its own history."""

    kind: Literal["several"] = "several"
    """More than one load."""
    loads: Annotated[tuple[Annotated[_EachSingle, Discriminator(by_kind)], ...], Field(min_length=1)]
    """Each as if it acted alone; their forces add up. The clamp turns in one way at most."""

    @model_validator(mode="after")
    def _turns_in_one_way(self) -> Self:
        rotations = sum(isinstance(load, ClampRotation) for load in self.loads)
        if rotations > 1:
            raise ValueError(f"loads: {rotations} of kind clamp_rotation; allowed: one at most")
        return self

    @property
    def parts(self) -> tuple[Single, ...]:
        """The loads of one history each that it is made of."""
        return self.loads

    @property
    def start_s(self) -> float:
        """When the first begins to act [s]."""
        return min(load.start_s for load in self.loads)

    def until(self, end_s: float) -> Self:
        """The same loads, which end at `end_s` [s] if they do not end before."""
        return self.model_copy(update={"loads": tuple(load.until(end_s) for load in self.loads)})

    def with_tables(self, root: Path) -> Self:
        """The same loads with the numbers of the files of their histories; ValueError as `with_table`."""
        return self.model_copy(update={"loads": tuple(load.with_tables(root) for load in self.loads)})

    def check(self, structure: Structure) -> None:
        """ValueError if any of them cannot be felt, or acts outside the span."""
        for number, load in enumerate(self.loads):
            try:
                load.check(structure)
            except ValueError as error:
                raise ValueError(f"loads[{number}]: {error}") from None


Load = Annotated[_EachSingle | Annotated[SeveralLoads, Tag("several")], Discriminator(by_kind)]


def turns_clamp(load: Load) -> bool:
    """Whether the clamp turns."""
    return any(isinstance(part, ClampRotation) for part in load.parts)


def loaded_span(load: _AlongTheSpan, span_m: float) -> tuple[float, float]:
    """Where the load begins and ends [m]; ValueError unless it lies within the span."""
    to_m = span_m if load.to_m is None else load.to_m
    if not 0.0 <= load.from_m < to_m <= span_m:
        raise ValueError(
            f"from_m, to_m: a load from {load.from_m:g} to {to_m:g} m does not lie within the span "
            f"(0 to {span_m:g} m)"
        )
    return load.from_m, to_m


def _axes_of(spreads: Sequence[Spread | MomentSpread | None]) -> list[Vector]:
    """The axes along or about which something acts."""
    return [axis for axis, spread in zip(AXES, spreads, strict=True) if spread is not None and spread.size]


def _is_felt(structure: Structure, directions: Iterable[Vector], follows: bool) -> bool:
    """Whether a force along any of the directions does work on the joints."""
    axes = enumerate(structure.clamp_axes)
    return _has_part(structure, directions, [k for k, axis in axes if axis in structure.felt_axes], follows)


def _turns(structure: Structure, directions: Iterable[Vector], follows: bool) -> bool:
    """Whether a moment about any of the directions does work on the joints.

    Joints of one kind feel it about their own axis; with a second kind they turn one another's.
    """
    own = [TURNS_ABOUT[joint] for joint in structure.ordered_joints if joint in TURNS_ABOUT]
    alone = len(own) < 2 and structure.straight
    return _has_part(structure, directions, own if alone else [0, 1, 2], follows)


def _on_axis(structure: Structure) -> bool:
    """Whether the centres of gravity lie on the elastic axis."""
    return structure.straight and not (
        structure.point_masses or any(structure.values_of("centre_of_gravity_offset_m"))
    )


def _has_part(structure: Structure, directions: Iterable[Vector], axes: Sequence[int], follows: bool) -> bool:
    """Whether a direction has a component along one of these axes, the clamp's or, if it follows, its own."""
    frame = AXES if follows else structure.clamp_axes
    return any(
        abs(sum(d * a for d, a in zip(direction, frame[k], strict=True)))
        > _ROUNDING * sum(map(abs, direction))
        for direction in directions
        for k in axes
    )
