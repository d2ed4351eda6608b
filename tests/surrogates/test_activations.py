"""σ, σ′ and σ″: derivatives of each other, the same compiled, safe at any argument."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

from flexsurr.config.study import Activation
from flexsurr.surrogates.activations import ACTIVATIONS, curvature, exponential, logarithm, slope, value

EPS = np.finfo(np.float64).eps


@njit
def compiled(tag, z, sigma, first, second):
    for i in range(z.size):
        sigma[i] = value(tag, z[i])
        first[i] = slope(tag, z[i])
        second[i] = curvature(tag, z[i])


def test_the_configuration_allows_exactly_these():
    assert set(Activation.__args__) == set(ACTIVATIONS)


@pytest.mark.parametrize("name", ACTIVATIONS)
def test_slope_and_curvature_are_derivatives(name):
    """By Richardson's extrapolation of central differences, away from ELU's corner."""
    sigma = ACTIVATIONS[name]
    z = np.linspace(-8.0, 8.0, 40)
    h = 1e-2

    def derivative(f):
        d = [(f(z + s) - f(z - s)) / (2 * s) for s in (h, h / 2, h / 4)]
        fourth = [(4 * b - a) / 3 for a, b in itertools.pairwise(d)]
        return (16 * fourth[1] - fourth[0]) / 15

    np.testing.assert_allclose(sigma.slope(z), derivative(sigma.value), atol=3e-12)
    np.testing.assert_allclose(sigma.curvature(z), derivative(sigma.slope), atol=3e-12)


@pytest.mark.parametrize("name", ACTIVATIONS)
def test_compiled_is_the_same(name):
    sigma = ACTIVATIONS[name]
    z = np.concatenate([np.linspace(-40.0, 40.0, 4001), np.geomspace(1e-9, 1e3, 200)])
    result = np.empty((3, z.size))
    compiled(sigma.tag, z, *result)
    for found, formula in zip(result, (sigma.value, sigma.slope, sigma.curvature), strict=True):
        expected = formula(z)
        np.testing.assert_allclose(found, expected, rtol=1e-14, atol=40 * EPS)


@pytest.mark.parametrize("name", ACTIVATIONS)
def test_no_argument_overflows(name):
    sigma = ACTIVATIONS[name]
    z = np.array([-1e100, -1e3, -750.0, 0.0, 750.0, 1e3, 1e100])
    result = np.empty((3, z.size))
    compiled(sigma.tag, z, *result)
    for array in (sigma.value(z), sigma.slope(z), sigma.curvature(z), *result):
        assert np.all(np.isfinite(array))


@pytest.mark.parametrize("name", ACTIVATIONS)
def test_nan_stays_nan(name):
    result = np.zeros((3, 1))
    compiled(ACTIVATIONS[name].tag, np.array([np.nan]), *result)
    assert np.isnan(result[1, 0])


@given(st.floats(-690.0, 690.0))
def test_exponential(z):
    assert exponential(z) == pytest.approx(np.exp(z), rel=3e-14)


@given(st.floats(1e-290, 1e290))
def test_logarithm(y):
    assert logarithm(y) == pytest.approx(np.log(y), rel=4 * EPS, abs=1e-300)
