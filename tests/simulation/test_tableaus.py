"""Coefficients, and the code written from them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.integrate._ivp import dop853_coefficients as published

from flexsurr.simulation import radau, unroll
from flexsurr.simulation.linear_solvers import factorise, solve
from flexsurr.simulation.tableaus import DOP853, GAUSS_LEGENDRE_4, GAUSS_LEGENDRE_6, RK4


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


@pytest.mark.parametrize("tableau", [GAUSS_LEGENDRE_4, GAUSS_LEGENDRE_6])
def test_gauss_legendre_coefficients(tableau):
    """Simplifying assumptions B(2s) and C(s), and the condition of symplecticity."""
    stages = len(tableau.c)
    nodes = np.array(tableau.c)
    a = np.array([dense_row(row, stages) for row in tableau.a])
    b = dense_row(tableau.b, stages)
    for k in range(1, 2 * stages + 1):
        assert b @ nodes ** (k - 1) == pytest.approx(1 / k, abs=1e-15)
    for k in range(1, stages + 1):
        assert a @ nodes ** (k - 1) == pytest.approx(nodes**k / k, abs=1e-15)
    product = b[:, None] * a
    assert product + product.T == pytest.approx(np.outer(b, b), abs=1e-15)


def test_radau_is_the_published_method():
    """A⁻¹'s eigenvalues and the stages' matrix."""
    root = np.sqrt(6)
    a = np.array(
        [
            [(88 - 7 * root) / 360, (296 - 169 * root) / 1800, (-2 + 3 * root) / 225],
            [(296 + 169 * root) / 1800, (88 + 7 * root) / 360, (-2 - 3 * root) / 225],
            [(16 - root) / 36, (16 + root) / 36, 1 / 9],
        ]
    )
    assert np.linalg.inv(radau._A_INVERSE) == pytest.approx(a, abs=1e-14)
    eigenvalues = [radau._MU_REAL, radau._MU_COMPLEX.real]
    published = [3 + 3 ** (2 / 3) - 3 ** (1 / 3), 3 + 0.5 * (3 ** (1 / 3) - 3 ** (2 / 3))]
    assert eigenvalues == pytest.approx(published, abs=1e-13)


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
