"""Polynomial Hamiltonians by linear least squares."""

from dataclasses import replace

import numpy as np
import pytest
from oscillator import free_responses

from flexsurr.surrogates import PolynomialHamiltonian, canonical_scaling
from flexsurr.surrogates.monomials import monomials_to_degree
from flexsurr.training import nmse, split_dataset
from flexsurr.training.least_squares import Triangle, fit_polynomial


def sampled(truth, samples=600, seed=0):
    """Random states and the field of `truth` there."""
    count = len(truth.state_names)
    x = np.random.default_rng(seed).uniform(-1.0, 1.0, (samples, count)) * truth.scaling.states(count)
    return split_dataset(
        np.arange(samples) % 5,
        x,
        truth.derivative(0.0, x),
        validation=[0],
        state_names=truth.state_names,
        state_units=truth.state_units,
    )


def random_polynomial(count, degree, keep):
    dataset = free_responses(4, 10)
    exponents = monomials_to_degree(count, degree)
    r = count // 2
    exponents = exponents[keep(exponents[:, :r].sum(axis=1), exponents[:, r:].sum(axis=1))]
    return PolynomialHamiltonian(
        np.random.default_rng(1).normal(size=len(exponents)),
        canonical_scaling(dataset.scales),
        tuple(f"{kind}_{k}" for kind in "qp" for k in range(r)),
        ("1",) * count,
        exponents,
    )


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("sizes", [(200,), (5, 60, 90, 45), (1,) * 200])
def test_rows_that_come_in_blocks_give_the_factor_of_all_at_once(sizes, order):
    rows = np.random.default_rng(3).normal(size=(200, 43)).copy(order)
    triangle = Triangle(40, targets=3)
    for block in np.split(rows, np.cumsum(sizes)[:-1]):
        triangle.add(block)
    assert np.array_equal(rows, np.random.default_rng(3).normal(size=(200, 43)))  # as they were
    factor = np.linalg.qr(rows, mode="r")
    np.testing.assert_allclose(np.abs(triangle._triangle), np.abs(factor), rtol=1e-12, atol=1e-12)
    solution, *_ = np.linalg.lstsq(*np.split(rows, [40], axis=1))
    np.testing.assert_allclose(triangle.solve(), solution, rtol=0, atol=1e-13)


def test_rows_must_be_finite():
    with pytest.raises(ValueError, match="infs or NaNs"):
        Triangle(2).add(np.array([[1.0, np.nan, 0.0]]))


KINDS = {
    "all": lambda q, p: q + p > 0,
    "even": lambda q, p: (q % 2 == 0) & (p % 2 == 0),
    "mechanical": lambda q, p: (p == 0) | (p == 2),
    "mechanical and even": lambda q, p: ((p == 0) | (p == 2)) & (q % 2 == 0),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("count", "degree"), [(2, 6), (4, 4)])
def test_a_polynomial_is_recovered_with_no_other_terms(count, degree, kind, monkeypatch):
    monkeypatch.setattr("flexsurr.training.least_squares.CHUNK", 5000)  # in many pieces
    truth = random_polynomial(count, degree, KINDS[kind])
    found = fit_polynomial(sampled(truth), degree)
    np.testing.assert_array_equal(found.exponents, truth.exponents)
    x = np.random.default_rng(2).uniform(-0.3, 0.3, (20, count))
    assert nmse(found.derivative(0.0, x), truth.derivative(0.0, x)) < 1e-26
    np.testing.assert_allclose(found.energy(x), truth.energy(x), rtol=1e-9, atol=1e-12)


def test_a_degree_too_many_does_no_harm():
    truth = random_polynomial(2, 4, KINDS["all"])
    dataset = sampled(truth)
    found = fit_polynomial(dataset, 8)
    assert nmse(found.derivative(0.0, dataset.x_validation), dataset.dx_validation) < 1e-22


def test_samples_that_leave_terms_undetermined():
    """On a line q = 0 nothing tells powers of q apart; the fit is still finite, and good on the line."""
    truth = random_polynomial(2, 4, KINDS["mechanical and even"])
    dataset = sampled(truth)
    on_line = dataset.x_train * [1e-9, 1.0]
    dataset = replace(dataset, x_train=on_line, dx_train=truth.derivative(0.0, on_line))
    found = fit_polynomial(dataset, 4)
    assert np.all(np.isfinite(found.parameters))
    assert nmse(found.derivative(0.0, on_line)[:, :1], dataset.dx_train[:, :1]) < 1e-20


def test_oscillator():
    """1/M(q) is no polynomial, but close to one; that the structure is symmetric is found by itself."""
    dataset = free_responses(8, 100)
    losses = []
    for degree in (4, 6, 8, 10):
        found = fit_polynomial(dataset, degree)
        assert not np.any(found.exponents % 2)
        losses.append(nmse(found.derivative(0.0, dataset.x_validation), dataset.dx_validation))
    assert losses[3] < 1e-14
    assert np.all(np.diff(np.log10(losses)) < -2.0)
