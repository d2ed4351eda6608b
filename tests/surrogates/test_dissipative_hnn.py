"""The D-HNN, the field in eq. 12: what its field is made of, and what it therefore cannot be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_surrogates import network

from flexsurr.surrogates import HNN, DissipativeHNN, Hamiltonian

SEEDS = st.integers(0, 2**32 - 1)


def jacobian(field, x, h=1e-3):
    """∂f/∂x by Richardson's extrapolation of central differences."""
    columns = []
    for e in np.eye(len(x)):
        d = [(field(x + s * e) - field(x - s * e)) / (2 * s) for s in (h, 2 * h)]
        columns.append((4 * d[0] - d[1]) / 3)
    return np.stack(columns, axis=-1)


@given(SEEDS)
def test_field_is_hamiltons_equations_and_a_gradient(seed):
    """q̇ = ∂H/∂p + ∂D/∂q, ṗ = −∂H/∂q + ∂D/∂p, with H and D differentiated as they are."""
    surrogate = network(DissipativeHNN, 4, (5, 3), "tanh", seed)
    x = np.random.default_rng(seed).uniform(-1.0, 1.0, 4)
    h, d = (jacobian(lambda x, k=k: surrogate.scaled_scalar(x, k)[None], x)[0] for k in range(2))
    expected = np.concatenate([h[2:] + d[:2], -h[:2] + d[2:]])
    np.testing.assert_allclose(surrogate.scaled_field(x), expected, atol=1e-7 * (1 + np.abs(expected).max()))


@given(SEEDS)
def test_its_criterion_of_integrability(seed):
    """∂q̇_k/∂q_j + ∂ṗ_j/∂p_k and ∂ṗ_k/∂q_j − ∂q̇_j/∂p_k are symmetric, whatever the weights.

    They are the second derivatives of D by q and p added, and those of H with a minus.
    """
    surrogate = network(DissipativeHNN, 6, (5,), "softplus", seed)
    x = np.random.default_rng(seed).uniform(-1.0, 1.0, 6)
    matrix = jacobian(surrogate.scaled_field, x)
    qq, qp, pq, pp = matrix[:3, :3], matrix[:3, 3:], matrix[3:, :3], matrix[3:, 3:]
    for criterion in (qq + pp.T, pq - qp.T):
        assert np.max(np.abs(criterion - criterion.T)) <= 1e-7 * (1.0 + np.max(np.abs(matrix)))


def test_without_dissipation_it_keeps_its_energy():
    surrogate = network(DissipativeHNN, 4, (5,), "softplus")
    surrogate.parameters[-5:] = 0.0
    x = np.random.default_rng(0).uniform(-1.0, 1.0, (6, 4)) * surrogate.scaling.states(4)
    h = 1e-6
    along = surrogate.derivative(0.0, x)
    rate = (surrogate.energy(x + h * along) - surrogate.energy(x - h * along)) / (2 * h)
    assert np.all(np.abs(rate) <= 1e-6 * np.max(np.abs(along)) * surrogate.scaling.energy)


def test_a_damped_oscillator_by_hand():
    """D = −c p²/2 damps, H = p²/2 + q²/2 turns; both as the small-argument limit of ½ log(1 + z²)."""
    small = 1e-4
    hidden = np.concatenate([small * np.eye(2).ravel(), np.zeros(2)])
    surrogate = network(DissipativeHNN, 2, (2,), "half_log")
    c = 0.3
    parameters = np.concatenate([hidden, [1 / small**2] * 2, hidden, [0.0, -c / small**2]])
    surrogate.parameters[:] = parameters
    q, p = 0.7, -0.4
    found = surrogate.scaled_field(np.array([q, p]))
    np.testing.assert_allclose(found, [p, -q - c * p], rtol=1e-6)


def test_it_has_an_energy_of_its_own():
    surrogate = network(DissipativeHNN, 4, (5,), "silu")
    assert isinstance(surrogate, Hamiltonian)
    assert surrogate.energy(np.zeros(4)) == pytest.approx(0.0)


def test_its_two_networks_share_nothing():
    """The parameters are those of H, then those of D; what is D's does not move H."""
    surrogate = network(DissipativeHNN, 6, (5, 4), "tanh")
    x = np.random.default_rng(3).uniform(-1.0, 1.0, 6)
    half = surrogate.parameter_count // 2
    assert surrogate.parameter_count == 2 * network(HNN, 6, (5, 4), "tanh").parameter_count
    before = [surrogate.scaled_scalar(x, k) for k in range(2)]
    surrogate.parameters[half:] += 0.1
    after = [surrogate.scaled_scalar(x, k) for k in range(2)]
    assert before[0] == after[0]
    assert before[1] != after[1]
