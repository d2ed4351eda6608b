"""What every surrogate with an energy obeys, whatever its weights."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_surrogates import HAMILTONIANS, network

from flexsurr.surrogates import HNN

EACH = pytest.mark.parametrize("surrogate", HAMILTONIANS.values(), ids=HAMILTONIANS.keys())
SEEDS = st.integers(0, 2**32 - 1)


def with_random_weights(surrogate, seed):
    weights = np.random.default_rng(seed).normal(size=surrogate.parameter_count)
    return replace(surrogate, parameters=weights)


def random_states(surrogate, seed, number=3):
    scales = surrogate.scaling.states(len(surrogate.state_names))
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (number, scales.size)) * scales


def jacobian(surrogate, x):
    """∂ẋ/∂x by differences in scaled states, made dimensionless."""
    count = len(surrogate.state_names)
    scales, rates, h = surrogate.scaling.states(count), surrogate.scaling.rates(count), 1e-4
    columns = []
    for e in np.eye(count):
        d = [
            (surrogate.derivative(0.0, x + s * e * scales) - surrogate.derivative(0.0, x - s * e * scales))
            / (2 * s)
            for s in (h, 2 * h)
        ]
        columns.append((4 * d[0] - d[1]) / 3 / rates)
    return np.stack(columns, axis=-1)


@EACH
@given(seed=SEEDS)
def test_energy_is_constant_along_the_field(surrogate, seed):
    """DH/dt = ∇H · ẋ = 0, the gradient by differences of H."""
    surrogate = with_random_weights(surrogate, seed)
    x = random_states(surrogate, seed)
    scales = surrogate.scaling.states(x.shape[-1])
    h = 1e-4
    along = surrogate.derivative(0.0, x)
    size = np.max(np.abs(along / scales))
    rate = (surrogate.energy(x + h * along / size) - surrogate.energy(x - h * along / size)) / (2 * h)
    assert np.all(
        np.abs(rate) <= 1e-6 * surrogate.scaling.energy * (1.0 + size * surrogate.scaling.time_s) ** 3
    )


@EACH
@given(seed=SEEDS)
def test_field_is_free_of_divergence(surrogate, seed):
    surrogate = with_random_weights(surrogate, seed)
    (x,) = random_states(surrogate, seed, 1)
    matrix = jacobian(surrogate, x)
    assert abs(np.trace(matrix)) <= 1e-8 * np.max(np.abs(matrix))


@EACH
@given(seed=SEEDS)
def test_hessian_is_symmetric(surrogate, seed):
    """Hamilton's equations turned back: −Ω ∂ẋ/∂x is the second derivative of H."""
    surrogate = with_random_weights(surrogate, seed)
    (x,) = random_states(surrogate, seed, 1)
    matrix = jacobian(surrogate, x)
    r = len(x) // 2
    hessian = np.concatenate([-matrix[r:], matrix[:r]])
    np.testing.assert_allclose(hessian, hessian.T, atol=1e-8 * np.max(np.abs(matrix)))


@EACH
def test_field_is_hamiltons_equations_of_the_energy(surrogate):
    (x,) = random_states(surrogate, 0, 1)
    scales = surrogate.scaling.states(len(x))
    h = 1e-5
    gradient = [
        (surrogate.energy(x + h * e) - surrogate.energy(x - h * e)) / (2 * h * e.sum())
        for e in np.diag(scales)
    ]
    r = len(x) // 2
    expected = np.concatenate([gradient[r:], np.negative(gradient[:r])])
    found = surrogate.derivative(0.0, x)
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-7 * np.max(np.abs(found)))


@EACH
def test_energy_is_zero_at_the_origin(surrogate):
    assert surrogate.energy(np.zeros(len(surrogate.state_names))) == 0.0


@EACH
def test_leading_axes_are_samples(surrogate):
    x = random_states(surrogate, 1, 6).reshape(2, 3, -1)
    dx, energy = surrogate.derivative(0.0, x), surrogate.energy(x)
    assert (dx.shape, energy.shape) == (x.shape, (2, 3))
    np.testing.assert_allclose(dx[1, 2], surrogate.derivative(0.0, x[1, 2]), rtol=1e-13)
    np.testing.assert_allclose(energy[1, 2], surrogate.energy(x[1, 2]), rtol=1e-13)


def test_one_neuron_by_hand():
    """H = c ½ log(1 + z²), z = w_q q + w_p p + b: q̇ = c w_p z / (1 + z²), ṗ = −c w_q z / (1 + z²)."""
    hnn = network(HNN, 2, (1,), "half_log")
    w_q, w_p, b, c = hnn.parameters
    s = hnn.scaling
    q, p = 0.3, -2.0
    z = w_q * q / s.q + w_p * p / s.p + b
    expected = s.energy * c * z / (1 + z * z) * np.array([w_p / s.p, -w_q / s.q])
    np.testing.assert_allclose(hnn.derivative(0.0, np.array([q, p])), expected, rtol=1e-14)
