import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flexsurr.beam.linear_solve import solve_positive_definite
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


@given(st.integers(1, 8), st.integers(0, 10**6))
def test_cholesky_solves_positive_definite_systems(n, seed):
    random = np.random.default_rng(seed)
    factor = random.normal(size=(n, n)) + 3.0 * np.eye(n)
    matrix, right = factor @ factor.T, random.normal(size=n)
    solution = right.copy()
    solve_positive_definite(np.tril(matrix).ravel(), solution, n)
    np.testing.assert_allclose(matrix @ solution, right, rtol=0.0, atol=1e-12 * np.linalg.cond(matrix))


def test_cholesky_of_an_indefinite_matrix_is_not_finite():
    solution = np.ones(2)
    solve_positive_definite(np.array([1.0, 0.0, 2.0, 1.0]), solution, 2)
    assert not np.isfinite(solution).all()
