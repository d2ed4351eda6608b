import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flexsurr.beam.trigonometry import sine_cosine


@given(st.floats(-1e4, 1e4))
def test_sine_and_cosine_are_those_of_libm_to_rounding(x):
    sine, cosine = sine_cosine(x)
    assert abs(sine - np.sin(x)) < 5e-16
    assert abs(cosine - np.cos(x)) < 5e-16


def test_sine_and_cosine_at_multiples_of_a_right_angle():
    for k in range(-40, 41):
        x = 0.5 * np.pi * k
        assert np.abs(np.array(sine_cosine(x)) - [np.sin(x), np.cos(x)]).max() < 5e-16
