"""The structure: a clamped beam of rigid elements and joint springs (config/structures/*.yaml)."""

import math
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.along_span import AlongSpan, FixedMass
from flexsurr.config.along_span import NotNegative as NotNegative
from flexsurr.config.along_span import Positive as Positive
from flexsurr.config.schema import Record, check_once

Joint = Literal["in_plane", "out_of_plane", "torsion", "axial"]
JOINTS: tuple[Joint, ...] = ("in_plane", "out_of_plane", "torsion", "axial")

Axis = tuple[float, float, float]


FEW = 100
"""Elements whose mass matrix is never singular for their number."""


class Structure(Record):
    """Properties of the lumped-mass beam, constant or along the span; units are in the names.

    Coordinates: x along the undeformed span, y to the left, z up. The order of `joints` in q is
    always that of `JOINTS`, whatever the order in the file.
    """

    name: str
    """What results and errors call it."""
    length_m: Positive
    """Span of the undeformed beam, from the clamp to the tip [m]; along its axis where that is curved."""
    elements: Annotated[int, Field(ge=1, le=1000)]
    """Rigid elements of equal length along the span, numbered from the clamp. Of bending more than some 250
    are refused, for their mass matrix is singular to rounding.
    """
    joints: Annotated[tuple[Joint, ...], Field(min_length=1)]
    """What gives way at the root of each element. in_plane bends about z, out_of_plane about y, torsion
    twists about x, axial stretches along x; each needs its stiffness.
    """
    mass_per_length_kg_m: Positive | None = None
    """Mass per span [kg/m]. Needed, here or in `along_span`, as are the stiffnesses of the joints."""
    bending_stiffness_in_plane_N_m2: Positive | None = None
    """EI of in-plane bending, in the plane of x and y [N m²]. Needed with the joint in_plane, of no effect
    without.
    """
    bending_stiffness_out_of_plane_N_m2: Positive | None = None
    """EI of out-of-plane bending, which lifts the tip [N m²]. Needed with the joint out_of_plane, of no
    effect without.
    """
    torsional_stiffness_N_m2: Positive | None = None
    """GJ [N m²]. Needed with the joint torsion, of no effect without."""
    axial_stiffness_N: Positive | None = None
    """EA [N]. Needed with the joint axial, of no effect without."""
    torsional_inertia_per_length_kg_m: NotNegative = 0.0
    """Mass moment of inertia per span about the centre of gravity, in torsion [kg m]. More than 0 with the
    joint torsion; 0 is allowed only with an offset of the centre of gravity and without the joint
    out_of_plane.
    """
    inertia_about_y_per_length_kg_m: NotNegative = 0.0
    """The part of it about y [kg m], which bending out of plane turns; about z it is the rest. 0: a flat
    section. It counts where rotary_inertia is exact.
    """
    chord_m: Positive = 0.1
    """Chord [m]; it only limits the offset of the centre of gravity."""
    centre_of_gravity_offset_m: float = 0.0
    """Centre of gravity from the elastic axis, positive along y, to the left [m]; at most a chord to either
    side.
    """
    along_span: AlongSpan | None = None
    """Properties that vary along the span, and an axis that is not straight. None: all are constant."""
    point_masses: tuple[FixedMass, ...] = ()
    """Bodies fixed to it."""
    joint_rotation: Literal["vector", "sequence"] = "vector"
    """How an element turns at its joints. vector: by one rotation, of components ψ about z, θ about −y and φ
    about x: of second order in the length of the elements. sequence: about z, then −y, then x, as the study
    has it: of first order where several joints bend and twist together. A single kind of joint turns either
    way alike.
    """
    rotary_inertia: Literal["exact", "constant"] = "exact"
    """exact: of each element's own tensor of inertia, as it turns. constant: the study's, in torsion alone,
    Tᵀ diag(I₀ l) T.
    """
    clamp_psi_deg: float = 0.0
    """The clamp is turned first about z [°]; positive turns the span to the left."""
    clamp_theta_deg: float = 0.0
    """Then about the turned −y [°]; positive lifts the span."""
    clamp_phi_deg: float = 0.0
    """Then about the turned x [°]; positive lowers the right side."""
    gravity_m_s2: NotNegative = 0.0
    """Size of the gravity along −z [m/s²]: 9.80665 on Earth. 0: none."""
    damping_in_plane_s: NotNegative = 0.0
    """Damping over stiffness of the in_plane joints (Rayleigh's β) [s]: a mode of ω rad/s has the damping
    ratio ½ β ω.
    """
    damping_out_of_plane_s: NotNegative = 0.0
    """The same of the out_of_plane joints [s]."""
    damping_torsion_s: NotNegative = 0.0
    """The same of the torsion joints [s]."""
    damping_axial_s: NotNegative = 0.0
    """The same of the axial joints [s]."""
    clamp_spring: Literal["tip_deflection", "half_element"] = "tip_deflection"
    """The spring at the clamp, where half an element bends. tip_deflection: 6 EI L / (l (3L − l)), l an
    element and L the span, exact under a small tip load; half_element: 2 EI / l. In torsion and stretch it is
    2 GJ / l and 2 EA / l either way.
    """

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        check_once(self.joints, "joints: ")
        self._check_table()
        if not self._has("mass_per_length_kg_m"):
            raise ValueError("mass_per_length_kg_m: needed, here or in along_span")
        for joint in self.joints:
            if not self._has(STIFFNESS_KEY[joint]):
                raise ValueError(f"{STIFFNESS_KEY[joint]}: needed for the joint {joint!r}")
        # An element's centre of gravity beside its axis resists torsion, but it rises in bending too: then
        # there are more coordinates than ways for the masses to move.
        offset_resists = (
            any(self.values_of("centre_of_gravity_offset_m")) and "out_of_plane" not in self.joints
        )
        inertia = self.values_of("torsional_inertia_per_length_kg_m")
        if "torsion" in self.joints and not any(inertia) and not offset_resists and not self.point_masses:
            raise ValueError(
                "torsional_inertia_per_length_kg_m: 0.0 is not allowed with the joint 'torsion', which would "
                "move no mass; allowed: more than 0"
            )
        self._check_sections()
        self._check_point_masses()
        return self

    def _check_table(self) -> None:
        table = self.along_span
        if table is None:
            return
        table.check_covers(self.length_m)
        fields = type(self).model_fields
        for key in table.given:
            if key in fields and getattr(self, key) != fields[key].default:
                raise ValueError(f"{key}: given here and in along_span; allowed: one of the two")

    def _check_sections(self) -> None:
        """At every station, or once where nothing varies."""
        count = 1 if self.along_span is None else len(self.along_span.stations_m)
        rows = zip(
            *(
                values * count if len(values) == 1 else values
                for values in (
                    self.values_of("centre_of_gravity_offset_m"),
                    self.values_of("chord_m"),
                    self.values_of("inertia_about_y_per_length_kg_m"),
                    self.values_of("torsional_inertia_per_length_kg_m"),
                )
            ),
            strict=True,
        )
        for offset, chord, about_y, about_x in rows:
            if abs(offset) > chord:
                raise ValueError(f"centre_of_gravity_offset_m: {offset} lies beyond the chord ({chord} m)")
            if about_y > about_x:
                raise ValueError(
                    f"inertia_about_y_per_length_kg_m: {about_y:g} is a part of "
                    f"torsional_inertia_per_length_kg_m: {about_x:g}; allowed: at most as much"
                )

    def _check_point_masses(self) -> None:
        for number, mass in enumerate(self.point_masses):
            if mass.at_m > self.length_m:
                raise ValueError(
                    f"point_masses[{number}].at_m: {mass.at_m:g} lies beyond the tip; allowed: 0 to "
                    f"{self.length_m:g}"
                )
        if self.point_masses and self.rotary_inertia == "constant":
            raise ValueError("rotary_inertia: 'constant' is not allowed with point_masses; allowed: 'exact'")

    def _has(self, key: str) -> bool:
        return None not in self.values_of(key)

    def values_of(self, key: str) -> tuple[Any, ...]:
        """The values of a property at the stations of the table, or its one value."""
        table = self.along_span
        column: tuple[Any, ...] | None = None if table is None else getattr(table, key)
        return (getattr(self, key),) if column is None else column

    @property
    def uniform(self) -> bool:
        """Whether nothing varies along the span, and nothing is fixed to it."""
        return self.along_span is None and not self.point_masses

    @property
    def plain(self) -> bool:
        """Whether its values alone show that it can move: of few elements, uniform, without weight, and all
        joints move mass.
        """
        turns_mass = "torsion" not in self.joints or self.torsional_inertia_per_length_kg_m > 0.0
        return self.elements <= FEW and self.uniform and self.gravity_m_s2 == 0.0 and turns_mass

    @property
    def straight(self) -> bool:
        """Whether the unloaded axis is the clamp's x, untwisted."""
        return self.along_span is None or not self.along_span.bends

    @property
    def turns_by_vector(self) -> bool:
        """Whether the joints turn by a rotation vector: with one kind of rotation it is the sequence."""
        rotations = [joint for joint in self.joints if joint != "axial"]
        return self.joint_rotation == "vector" and len(rotations) > 1

    @property
    def identity(self) -> dict[str, Any]:
        """All of it that names results: keys that came later are left out where they say what was so before.

        So the runs of a structure keep their names.
        """
        values = self.model_dump(mode="json")
        return {key: value for key, value in values.items() if BEFORE.get(key, ...) != value}

    @property
    def ordered_joints(self) -> tuple[Joint, ...]:
        """The joint kinds of this structure in the order of their blocks in q."""
        return tuple(joint for joint in JOINTS if joint in self.joints)

    @property
    def coordinates(self) -> int:
        """n, the number of generalised coordinates: joint kinds times elements."""
        return len(self.joints) * self.elements

    @property
    def dissipates(self) -> bool:
        """Whether any of its joints is damped."""
        return any(self.damping_s(joint) > 0.0 for joint in self.joints)

    @property
    def clamp_axes(self) -> tuple[Axis, Axis, Axis]:
        """x, y and z of the turned clamp: ψ about z, θ about −y (so that positive θ lifts x), φ about x."""
        angles = (self.clamp_psi_deg, self.clamp_theta_deg, self.clamp_phi_deg)
        cz, cy, cx = (math.cos(math.radians(angle)) for angle in angles)
        sz, sy, sx = (math.sin(math.radians(angle)) for angle in angles)
        return (
            (cz * cy, sz * cy, sy),
            (-sz * cx - cz * sy * sx, cz * cx - sz * sy * sx, cy * sx),
            (sz * sx - cz * sy * cx, -cz * sx - sz * sy * cx, cy * cx),
        )

    @property
    def felt_axes(self) -> tuple[Axis, ...]:
        """Axes of the clamp along which a force on the elastic axis does work as the joints move."""
        x, y, z = self.clamp_axes
        if not self.straight:
            return x, y, z
        match tuple(joint for joint in self.ordered_joints if joint != "axial"):
            case () | ("torsion",):
                return (x,) if "axial" in self.joints else ()
            case ("in_plane",):
                return x, y
            case ("out_of_plane",):
                return x, z
            case _:
                return x, y, z

    def section_stiffness(self, joint: Joint) -> float | None:
        """EI, GJ [N m²] or EA [N] that the springs of this joint kind come from; None where it varies."""
        value: float | None = getattr(self, STIFFNESS_KEY[joint])
        return value

    def damping_s(self, joint: Joint) -> float:
        """Rayleigh coefficient β [s] of this joint kind: C = K β."""
        value: float = getattr(self, f"damping_{joint}_s")
        return value


STIFFNESS_KEY: dict[Joint, str] = {
    "in_plane": "bending_stiffness_in_plane_N_m2",
    "out_of_plane": "bending_stiffness_out_of_plane_N_m2",
    "torsion": "torsional_stiffness_N_m2",
    "axial": "axial_stiffness_N",
}

BEFORE: dict[str, Any] = {
    "along_span": None,
    "point_masses": [],
    "inertia_about_y_per_length_kg_m": 0.0,
    "joint_rotation": "sequence",
    "rotary_inertia": "constant",
}
"""What the keys that came later stood for before there were any."""
