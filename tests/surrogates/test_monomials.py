"""Sets of monomials and their derivatives."""

import math

import numpy as np
import pytest

from flexsurr.surrogates.monomials import (
    closed,
    differentiate,
    evaluate_monomials,
    factors,
    monomials_to_degree,
    products,
    pull_back,
    runs,
    write_monomials,
)


@pytest.mark.parametrize(("variables", "degree"), [(1, 7), (2, 10), (4, 5), (6, 3)])
def test_count_is_binomial(variables, degree):
    exponents = monomials_to_degree(variables, degree)
    assert len(exponents) == math.comb(variables + degree, degree) - 1
    assert len({tuple(row) for row in exponents}) == len(exponents)
    assert exponents.sum(axis=1).max() == degree


def test_values_by_hand():
    exponents = np.array([[0, 0], [2, 1], [0, 3]])
    np.testing.assert_allclose(evaluate_monomials(exponents, np.array([3.0, 2.0])), [1.0, 18.0, 8.0])


def test_derivatives_by_complex_step():
    exponents = monomials_to_degree(3, 4)
    x = np.array([0.3, -0.7, 1.1])
    lower, tensor = differentiate(exponents)
    found = np.einsum("k,jki->ji", evaluate_monomials(lower, x), tensor)
    for j in range(3):
        stepped = evaluate_monomials(exponents, x + 1e-30j * np.eye(3)[j])
        np.testing.assert_allclose(found[j], stepped.imag / 1e-30, rtol=1e-13, atol=1e-15)


def test_products_rebuild_a_sparse_set():
    """Of p² q⁴ alone: the lower set must hold what its members are built from."""
    lower, _ = differentiate(np.array([[4, 2]]))
    parents, variables = products(lower)
    x = np.array([1.3, -0.4])
    values = [1.0]
    for parent, variable in zip(parents, variables, strict=True):
        values.append(values[parent] * x[variable])
    np.testing.assert_allclose(values, evaluate_monomials(lower, x), rtol=1e-14)


@pytest.mark.parametrize("parity", ["all", "even"])
def test_factors_rebuild_a_set_from_itself(parity):
    exponents = np.concatenate([np.zeros((1, 3), dtype=np.int64), monomials_to_degree(3, 6)])
    if parity == "even":
        exponents = exponents[exponents.sum(axis=1) % 2 == 0]
    x = np.array([1.3, -0.4, 0.7])
    available = np.concatenate([x, np.outer(x, x)[np.tril_indices(3)]])
    values = [1.0]
    for parent, factor in zip(*factors(exponents), strict=True):
        values.append(values[parent] * available[factor])
    np.testing.assert_allclose(values, evaluate_monomials(exponents, x), rtol=1e-14)


def test_a_closed_set_can_be_built_and_holds_few_more():
    wanted = np.array([[0, 0, 5], [4, 2, 0], [1, 1, 1]])
    found = closed(wanted)
    factors(found)
    rows = [tuple(row) for row in found.tolist()]
    assert {tuple(row) for row in wanted.tolist()} <= set(rows)
    # besides the constant, what two divisions by their last variables lead to
    assert rows[1:] == [
        (0, 0, 1),
        (1, 0, 0),
        (2, 0, 0),
        (0, 0, 3),
        (1, 1, 1),
        (4, 0, 0),
        (0, 0, 5),
        (4, 2, 0),
    ]


@pytest.mark.parametrize(("parity", "pieces"), [("all", 6 * 5 + 3), ("even", 6 * 3)])
def test_runs_rebuild_a_set_in_one_piece_for_each_factor_and_degree(parity, pieces):
    """Degrees 1 to 6 of three variables: of degree 1 three variables, of each other six products."""
    exponents = np.concatenate([np.zeros((1, 3), dtype=np.int64), monomials_to_degree(3, 6)])
    if parity == "even":
        exponents = exponents[exponents.sum(axis=1) % 2 == 0]
    exponents = exponents[np.r_[0, 1 + np.random.default_rng(0).permutation(len(exponents) - 1)]]
    exponents = exponents[np.argsort(exponents.sum(axis=1), kind="stable")]
    x = np.array([1.3, -0.4, 0.7])
    available = np.concatenate([x, np.outer(x, x)[np.tril_indices(3)]])
    order, found = runs(exponents)
    assert len(found) == pieces
    values = np.ones(len(exponents))
    for factor, parent, first, length in found.astype(int):
        values[first : first + length] = values[parent : parent + length] * available[factor]
    np.testing.assert_allclose(values, evaluate_monomials(exponents[order], x), rtol=1e-14)


@pytest.mark.parametrize("variables", [1, 2, 3])
@pytest.mark.parametrize("parity", ["all", "even"])
def test_pulling_back_is_the_derivative_by_each_variable(variables, parity):
    """Of Σ a φ. With one variable, monomials of all degrees have the same factor."""
    exponents = np.vstack([np.zeros((1, variables), dtype=np.int64), monomials_to_degree(variables, 8)])
    if parity == "even":
        exponents = exponents[exponents.sum(axis=1) % 2 == 0]
    rng, count = np.random.default_rng(variables), len(exponents)
    x, by_monomial = rng.uniform(-1.0, 1.0, variables), rng.normal(size=count)
    order, pieces = runs(exponents)
    slopes = variables + variables * (variables + 1) // 2
    phi = 2 * slopes
    work = np.concatenate([x, np.zeros(phi - variables + count), by_monomial[order]])
    write_monomials(pieces, variables, phi, work)
    pull_back(pieces, variables, phi, phi + count, slopes, work)
    lowered, tensor = differentiate(exponents)
    expected = (tensor @ by_monomial) @ evaluate_monomials(lowered, x)
    np.testing.assert_allclose(work[slopes : slopes + variables], expected, rtol=1e-11)


@pytest.mark.parametrize(
    ("exponents", "reason"), [([[1, 0]], "constant"), ([[0, 0], [2, 1]], r"monomial \(2, 1\)")]
)
def test_a_set_that_cannot_be_built_is_refused(exponents, reason):
    with pytest.raises(ValueError, match=reason):
        factors(np.array(exponents))
