"""A solid rectangular section of one material: what it gives the beam."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Material:
    """An isotropic, linearly elastic material."""

    young_Pa: float
    poisson: float
    density_kg_m3: float

    @property
    def shear_Pa(self) -> float:
        """G = E / (2 (1 + ν))."""
        return self.young_Pa / (2.0 * (1.0 + self.poisson))


MATERIALS = {
    # EN 1993-1-1, 3.2.6; density: EN 1991-1-1, table A.4
    "steel": Material(young_Pa=210e9, poisson=0.3, density_kg_m3=7850.0),
    # EN 1999-1-1, 3.2.5
    "aluminium": Material(young_Pa=70e9, poisson=0.3, density_kg_m3=2700.0),
}
"""Materials by name, with the values of the design standards."""


def torsion_constant(a_m: float, b_m: float) -> float:
    """Saint-Venant's J of a solid rectangle with sides a and b [m⁴].

    J = a b³/3 (1 − 192/π⁵ b/a Σ tanh(n π a / 2b) / n⁵), n = 1, 3, 5, …, with b the shorter side: S. P.
    Timoshenko and J. N. Goodier, Theory of Elasticity, torsion of a rectangular bar.
    """
    long, short = max(a_m, b_m), min(a_m, b_m)
    series = sum(math.tanh(0.5 * n * math.pi * long / short) / n**5 for n in range(1, 40, 2))
    return long * short**3 / 3.0 * (1.0 - 192.0 / math.pi**5 * short / long * series)


def rectangle(width_m: float, height_m: float, material: Material) -> dict[str, float]:
    """The keys of a structure for a solid rectangle, `width_m` along y and `height_m` along z [m]."""
    area, young = width_m * height_m, material.young_Pa
    out_of_plane, in_plane = area * height_m**2 / 12.0, area * width_m**2 / 12.0
    return {
        "mass_per_length_kg_m": material.density_kg_m3 * area,
        "bending_stiffness_out_of_plane_N_m2": young * out_of_plane,
        "bending_stiffness_in_plane_N_m2": young * in_plane,
        "torsional_stiffness_N_m2": material.shear_Pa * torsion_constant(width_m, height_m),
        "axial_stiffness_N": young * area,
        "torsional_inertia_per_length_kg_m": material.density_kg_m3 * (out_of_plane + in_plane),
        "inertia_about_y_per_length_kg_m": material.density_kg_m3 * out_of_plane,
        "chord_m": width_m,
    }
