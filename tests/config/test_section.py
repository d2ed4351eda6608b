"""A rectangular section against what is known of it."""

import pytest

from flexsurr.config.section import MATERIALS, Material, rectangle, torsion_constant
from flexsurr.config.structure import STIFFNESS_KEY, Structure


def test_torsion_of_squares_and_strips_is_saint_venants():
    """Timoshenko and Goodier's table: J = k a b³, k = 0.1406 (1), 0.229 (2), 0.281 (4), 1/3 (∞)."""
    for ratio, k in ((1.0, 0.1406), (2.0, 0.229), (4.0, 0.281), (10.0, 0.312), (1e4, 0.3333)):
        assert torsion_constant(ratio * 0.02, 0.02) == pytest.approx(k * ratio * 0.02**4, rel=2e-3)
        assert torsion_constant(0.02, ratio * 0.02) == torsion_constant(ratio * 0.02, 0.02)


def test_a_rectangle_gives_every_joint_what_it_needs():
    section = rectangle(0.03, 0.01, MATERIALS["steel"])
    assert section["mass_per_length_kg_m"] == pytest.approx(2.355)
    assert section["bending_stiffness_out_of_plane_N_m2"] == pytest.approx(525.0)
    assert section["bending_stiffness_in_plane_N_m2"] == pytest.approx(9.0 * 525.0)
    assert section["torsional_inertia_per_length_kg_m"] == pytest.approx(2.355 * (0.03**2 + 0.01**2) / 12.0)
    assert section["inertia_about_y_per_length_kg_m"] == pytest.approx(2.355 * 0.01**2 / 12.0)
    beam = Structure(name="bar", length_m=1.0, elements=4, joints=tuple(STIFFNESS_KEY), **section)
    assert all(beam.section_stiffness(joint) for joint in beam.joints)


def test_shear_follows_from_poissons_ratio():
    assert Material(young_Pa=2.6, poisson=0.3, density_kg_m3=1.0).shear_Pa == pytest.approx(1.0)
