"""Small linear systems: what is solved is solved, and what is not definite is not finite."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flexsurr.simulation.linear_solvers import solve_packed, solve_positive_definite


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


@given(st.integers(1, 6), st.integers(0, 10**6))
def test_by_rows_and_packed_the_solution_is_the_same(n, seed):
    random = np.random.default_rng(seed)
    factor = random.normal(size=(n, n)) + 3.0 * np.eye(n)
    matrix, solution = factor @ factor.T, random.normal(size=n)
    work = np.concatenate([matrix[np.tril_indices(n)], solution])
    solve_packed(work, 0, n * (n + 1) // 2, n)
    solve_positive_definite(np.tril(matrix).ravel(), solution, n)
    np.testing.assert_allclose(work[-n:], solution, rtol=0.0, atol=1e-12 * np.linalg.cond(matrix))
