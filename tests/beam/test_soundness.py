import numpy as np
import pytest
from hypothesis import assume, given, reject
from hypothesis import strategies as st
from pydantic import ValidationError
from structures import ALL_JOINTS, CANTILEVER, FORMS, change

from flexsurr.beam.soundness import check_structure, unit_hint


@pytest.mark.parametrize("form", range(len(FORMS)))
def test_sound_structures_pass(form):
    structure = change(ALL_JOINTS, **FORMS[form])
    check_structure(structure)
    assert unit_hint(structure) == ""


@given(
    joints=st.sets(st.sampled_from(["in_plane", "out_of_plane", "torsion", "axial"]), min_size=1),
    elements=st.integers(1, 12),
    inertia=st.floats(0.0, 1.0),
    offset=st.floats(-1.0, 1.0),
    inertias=st.sampled_from(["exact", "constant"]),
)
def test_a_plain_structure_is_sound(joints, elements, inertia, offset, inertias):
    """What the plan takes from the values alone is what the matrices say."""
    assume(inertia == 0.0 or inertia > 1e-6)
    values = {
        "joints": tuple(joints),
        "elements": elements,
        "torsional_inertia_per_length_kg_m": inertia,
        "centre_of_gravity_offset_m": offset,
        "rotary_inertia": inertias,
        "gravity_m_s2": 0.0,
    }
    try:
        structure = change(ALL_JOINTS, **values)
    except ValidationError:
        reject()  # its file is refused already
    if structure.plain:
        check_structure(structure)


def test_a_joint_that_moves_no_mass_is_named():
    """Torsion whose masses lie on the axis but for one body, which bending out of plane moves alike."""
    massless = ALL_JOINTS.model_copy(
        update={"torsional_inertia_per_length_kg_m": 0.0, "centre_of_gravity_offset_m": 0.0}
    )
    with pytest.raises(ValueError, match="joints: 'torsion' moves no mass of its own"):
        check_structure(massless)


def test_more_elements_than_rounding_allows_are_refused():
    """Of 450 the first frequency would be wrong by 85 %."""
    check_structure(change(CANTILEVER, elements=200))
    many = change(CANTILEVER, elements=450)
    assert not many.plain
    with pytest.raises(ValueError, match="elements: 450 is not allowed; allowed: fewer, such as 100"):
        check_structure(many)


def test_a_structure_whose_mass_matrix_is_singular_gives_a_hint():
    values = {"torsional_inertia_per_length_kg_m": 1e-18, "centre_of_gravity_offset_m": 0.05}
    line = change(ALL_JOINTS, **values, inertia_about_y_per_length_kg_m=0.0)
    assert "is singular to rounding: are lengths in m" in unit_hint(line)


def test_a_structure_that_buckles_under_its_own_weight_is_refused():
    pole = change(CANTILEVER, clamp_theta_deg=90.0, gravity_m_s2=9.81, mass_per_length_kg_m=60.0)
    with pytest.raises(
        ValueError, match=r"gravity_m_s2: cantilever: buckles under 6[5-9]\.?\d* % of its own"
    ):
        check_structure(pole)
    # Greenhill: q L³ / EI = 7.837
    least = 7.837 * 50.0 / 9.81
    check_structure(change(pole, mass_per_length_kg_m=0.95 * least))


@pytest.mark.parametrize("factor", [1e-9, 1e9])
def test_units_mistaken_give_a_hint(factor):
    odd = change(CANTILEVER, bending_stiffness_out_of_plane_N_m2=50.0 * factor)
    check_structure(odd)
    assert f"the first frequency of cantilever is {55.63 * np.sqrt(factor):.3g} rad/s" in unit_hint(odd)
    assert "rad/s: are lengths in m" in unit_hint(odd)
