"""Coefficients, and the code written from them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.integrate._ivp import dop853_coefficients as published

from flexsurr.simulation import unroll
from flexsurr.simulation.collocation import collocation_matrix, lagrange
from flexsurr.simulation.linear_solver import factorise, solve
from flexsurr.simulation.tableaus import DOP853, RK4


def dense_row(row, size):
    return np.array([row.get(j, 0.0) for j in range(size)])


@pytest.mark.parametrize("tableau", [RK4, DOP853.method, DOP853.further])
def test_rows_sum_to_their_nodes(tableau):
    for node, row in zip(tableau.c, tableau.a, strict=True):
        assert sum(row.values()) == pytest.approx(node, abs=1e-13)


def test_dop853_is_the_published_method():
    method, further = DOP853.method, DOP853.further
    assert [*method.c, 1.0, *further.c] == pytest.approx(published.C, abs=1e-15)
    a = np.array([dense_row(row, 16) for row in [*method.a, method.b, *further.a]])
    assert np.array_equal(a, published.A)
    assert np.array_equal(dense_row(method.b, 12), published.B)
    assert np.array_equal(dense_row(DOP853.error_3, 13), published.E3)
    assert np.array_equal(dense_row(DOP853.error_5, 13), published.E5)
    assert np.array_equal([dense_row(row, 16) for row in DOP853.dense], published.D)


def test_the_unrolled_methods_are_those_of_the_tableaus():
    assert unroll.DESTINATION.read_text(encoding="utf-8") == unroll.source()


@pytest.mark.parametrize("stages", [1, 2, 3])
def test_gauss_legendre_coefficients(stages):
    """Simplifying assumptions B(2s) and C(s), and the condition of symplecticity."""
    nodes = 0.5 + 0.5 * np.polynomial.legendre.leggauss(stages)[0]
    a = collocation_matrix(nodes, nodes)
    b = collocation_matrix(nodes, np.ones(1))[0]
    for k in range(1, 2 * stages + 1):
        assert b @ nodes ** (k - 1) == pytest.approx(1 / k, abs=1e-15)
    for k in range(1, stages + 1):
        assert a @ nodes ** (k - 1) == pytest.approx(nodes**k / k, abs=1e-15)
    product = b[:, None] * a
    assert product + product.T == pytest.approx(np.outer(b, b), abs=1e-15)


@given(st.floats(-2.0, 2.0))
def test_lagrange_reproduces_polynomials(theta):
    nodes = np.array([0.1, 0.4, 0.9])
    assert lagrange(nodes, np.array([theta]))[0] @ nodes**2 == pytest.approx(theta**2, abs=1e-12)


@pytest.mark.parametrize("dtype", [np.float64, np.complex128])
@given(data=st.data(), d=st.integers(1, 6))
def test_linear_systems(dtype, data, d):
    entries = arrays.arrays(np.float64, (2, d, d + 1), elements=st.floats(-1.0, 1.0, width=32))
    real, imaginary = data.draw(entries)
    both = (real + 1j * imaginary if dtype is np.complex128 else real).astype(dtype)
    a, b = np.ascontiguousarray(both[:, :-1]), np.ascontiguousarray(both[:, -1])
    factors, pivots, x = a.copy(), np.empty(d, dtype=np.int64), b.copy()
    if not factorise(factors, pivots):
        assert np.linalg.matrix_rank(a) < d
        return
    solve(factors, pivots, x)
    if np.linalg.cond(a) < 1e8:
        assert a @ x == pytest.approx(b, abs=1e-7)
