import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from flexsurr.beam.rotation_vector import crosses, rotation, stumpff, stumpff_4_5, tangent_rate

VECTORS = arrays(float, 3, elements=st.floats(-3.5, 3.5))
STEP = 1e-30


@given(VECTORS)
def test_it_turns_about_its_direction_by_its_length(u):
    np.testing.assert_allclose(rotation(u)[0], Rotation.from_rotvec(u).as_matrix(), atol=1e-13)


@given(VECTORS, VECTORS)
def test_the_tangent_gives_the_angular_velocity(u, rate):
    turned, tangent = rotation(u)
    moved = rotation(u + 1j * STEP * rate)[0].imag / STEP
    np.testing.assert_allclose(turned.T @ moved, crosses(tangent @ rate), atol=1e-12)
    np.testing.assert_allclose(turned @ tangent, tangent.T, atol=1e-13)


@given(VECTORS, VECTORS)
def test_the_tangent_moves_as_its_rate_says(u, rate):
    moved = rotation(u + 1j * STEP * rate)[1].imag.T / STEP
    np.testing.assert_allclose(tangent_rate(u, rate), moved, atol=1e-12)


def test_nothing_is_lost_at_a_vanishing_angle():
    c1, c2, c3, c4, c5 = (float(c) for c in stumpff(np.array(0.0)))
    assert (c1, c2, c3, c4, c5) == (1.0, 1 / 2, 1 / 6, 1 / 24, 1 / 120)


@given(st.floats(0.0, 6.28))
def test_stumpffs_functions_are_sines_and_cosines(angle):
    c1, c2, *_ = stumpff(np.array(angle**2))
    np.testing.assert_allclose([c1 * angle, c2 * angle**2], [np.sin(angle), 1.0 - np.cos(angle)], atol=1e-13)
    np.testing.assert_allclose(stumpff_4_5(angle**2), stumpff(np.array(angle**2))[3:], rtol=1e-14)
