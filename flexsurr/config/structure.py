"""The structure: a clamped beam of rigid elements and joint springs (config/structures/*.yaml)."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.schema import Record

Joint = Literal["in_plane", "out_of_plane", "torsion", "axial"]
JOINTS: tuple[Joint, ...] = ("in_plane", "out_of_plane", "torsion", "axial")

Axis = tuple[float, float, float]
Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]


class Structure(Record):
    """Properties of the lumped-mass beam, constant along the span; units are in the names.

    Coordinates: x along the undeformed span, y to the left, z up. The order of `joints` in q is
    always that of `JOINTS`, whatever the order in the file.
    """

    name: str
    """What results and errors call it."""
    length_m: Positive
    """Span of the undeformed beam, from the clamp to the tip [m]."""
    elements: Annotated[int, Field(ge=1)]
    """Rigid elements of equal length along the span, numbered from the clamp."""
    joints: Annotated[tuple[Joint, ...], Field(min_length=1)]
    """What gives way at the root of each element. in_plane bends about z, out_of_plane about y, torsion
    twists about x, axial stretches along x; each needs its stiffness.
    """
    mass_per_length_kg_m: Positive
    """Mass per span [kg/m]."""
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
    chord_m: Positive = 0.1
    """Chord [m]; it only limits the offset of the centre of gravity."""
    centre_of_gravity_offset_m: float = 0.0
    """Centre of gravity from the elastic axis, positive along y, to the left [m]; at most a chord to either
    side.
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
        if len(set(self.joints)) != len(self.joints):
            raise ValueError("joints: each kind at most once")
        for joint in self.joints:
            if self.section_stiffness(joint) is None:
                raise ValueError(f"{STIFFNESS_KEY[joint]}: needed for the joint {joint!r}")
        # An element's centre of gravity beside its axis resists torsion, but it rises in bending too: then
        # there are more coordinates than ways for the masses to move.
        offset_resists = self.centre_of_gravity_offset_m != 0.0 and "out_of_plane" not in self.joints
        if "torsion" in self.joints and self.torsional_inertia_per_length_kg_m == 0.0 and not offset_resists:
            raise ValueError(
                "torsional_inertia_per_length_kg_m: 0.0 is not allowed with the joint 'torsion', which would "
                "move no mass; allowed: more than 0"
            )
        if abs(self.centre_of_gravity_offset_m) > self.chord_m:
            raise ValueError(
                f"centre_of_gravity_offset_m: {self.centre_of_gravity_offset_m} lies beyond the chord "
                f"({self.chord_m} m)"
            )
        return self

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
        """EI, GJ [N m²] or EA [N] that the springs of this joint kind come from."""
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
