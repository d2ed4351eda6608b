"""Port-Hamiltonian surrogates are passive and mechanical, whatever their parameters."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_surrogates import (
    PLANES,
    PORT_HAMILTONIANS,
    pair_scaling,
    port_network,
    port_polynomial,
    states,
)

from flexsurr.surrogates import FeatureScaling, Hamiltonian, PolynomialPortHamiltonian, compiled
from flexsurr.surrogates.packed import lower, semidefinite_factor
from flexsurr.surrogates.sparse_mass import looking_up_pays

SEEDS = st.integers(0, 2**32 - 1)
MAKERS = {
    "polynomial": lambda seed: port_polynomial(6, 4, even=seed % 2 == 0, seed=seed),
    "network": lambda seed: port_network(6, 6, "tanh", seed, even=seed % 2 == 0),
    "entries": lambda seed: port_network(6, 6, "tanh", seed, even=seed % 2 == 0, factored=False),
}
EACH = pytest.mark.parametrize("surrogate", PORT_HAMILTONIANS.values(), ids=PORT_HAMILTONIANS.keys())


def random_states(surrogate, seed, number=4):
    scales = surrogate.scaling.states(len(surrogate.state_names))
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (number, scales.size)) * scales


def energy_rate(surrogate, x, h=1e-3):
    """∇H · ẋ by Richardson's extrapolation of central differences along ẋ."""
    along = surrogate.derivative(0.0, x)
    h = h / np.max(np.abs(along / surrogate.scaling.states(x.shape[-1])))
    d = [(surrogate.energy(x + s * along) - surrogate.energy(x - s * along)) / (2 * s) for s in (h, 2 * h)]
    return (4 * d[0] - d[1]) / 3


@pytest.mark.parametrize("kind", MAKERS)
@given(seed=SEEDS)
@settings(max_examples=60)
def test_energy_never_grows(kind, seed):
    """DH/dt = −q̇ᵀ C q̇ ≤ 0 at every state, with the energy differentiated along the field."""
    surrogate = MAKERS[kind](seed)
    x = random_states(surrogate, seed)
    rates = surrogate.derivative(0.0, x)[:, :3]
    dissipated = np.einsum("si,ij,sj->s", rates, surrogate.damping, rates)
    assert np.all(dissipated >= -1e-12 * np.max(np.abs(dissipated)))
    found = energy_rate(surrogate, x)
    size = np.max(np.abs(rates / surrogate.scaling.rates(6)[:3])) ** 2
    tolerance = 1e-6 * surrogate.scaling.energy / surrogate.scaling.action * surrogate.scaling.energy
    np.testing.assert_allclose(found, -dissipated, rtol=1e-6, atol=tolerance * (1.0 + size) ** 2)


@given(SEEDS)
def test_a_networks_energy_is_positive_anywhere(seed):
    surrogate = port_network(6, 6, "softplus", seed)
    x = 30.0 * random_states(surrogate, seed)
    assert np.all(surrogate.energy(x) > 0.0)
    smallest = np.linalg.eigvalsh(surrogate.scaled_mass(x[:, :3] / surrogate.scaling.states(6)[:3]))[:, 0]
    assert np.all(smallest >= 0.1)


@EACH
def test_momentum_is_mass_times_velocity(surrogate):
    (x,) = random_states(surrogate, 3, 1)
    r = len(x) // 2
    np.testing.assert_allclose(surrogate.mass_matrix(x[:r]) @ surrogate.derivative(0.0, x)[:r], x[r:])


@EACH
def test_matrices_are_symmetric_and_the_damping_semidefinite(surrogate):
    (x,) = random_states(surrogate, 4, 1)
    for matrix in (surrogate.mass_matrix(x[: len(x) // 2]), surrogate.stiffness, surrogate.damping):
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-12 * np.max(np.abs(matrix)))
    assert np.min(np.linalg.eigvalsh(surrogate.damping)) >= -1e-12 * np.max(np.abs(surrogate.damping))


@EACH
def test_derivatives_of_the_mass_matrix(surrogate):
    q = np.random.default_rng(5).uniform(-1.0, 1.0, len(surrogate.state_names) // 2)
    for k, e in enumerate(np.eye(q.size)):
        d = [
            (surrogate.scaled_mass(q + h * e) - surrogate.scaled_mass(q - h * e)) / (2 * h)
            for h in (1e-3, 2e-3)
        ]
        expected = (4 * d[0] - d[1]) / 3
        np.testing.assert_allclose(surrogate.scaled_mass_derivatives(q)[k], expected, atol=1e-9)


@EACH
def test_energy_is_zero_at_rest_and_leading_axes_are_samples(surrogate):
    assert isinstance(surrogate, Hamiltonian)
    assert surrogate.energy(np.zeros(len(surrogate.state_names))) == 0.0
    x = random_states(surrogate, 1, 6).reshape(2, 3, -1)
    dx, energy = surrogate.derivative(0.0, x), surrogate.energy(x)
    assert (dx.shape, energy.shape) == (x.shape, (2, 3))
    np.testing.assert_allclose(dx[1, 2], surrogate.derivative(0.0, x[1, 2]), rtol=1e-12)
    np.testing.assert_allclose(energy[1, 2], surrogate.energy(x[1, 2]), rtol=1e-12)


def test_one_pair_by_hand():
    """M = 2 + 3 q², K = 5, C = 0.7² in units of one: q̇ = p / M, ṗ = 3 q q̇² − 5 q − 0.49 q̇."""
    scaling = replace(pair_scaling(2), q=(1.0,), action=1.0, energy=1.0)
    exponents = np.array([[0], [2]])
    surrogate = PolynomialPortHamiltonian(
        np.array([2.0, 3.0, 5.0, 0.7]), scaling, **states(2), exponents=exponents
    )
    q, p = 0.4, -1.1
    rate = p / (2 + 3 * q**2)
    expected = [rate, 3 * q * rate**2 - 5 * q - 0.49 * rate]
    np.testing.assert_allclose(surrogate.derivative(0.0, np.array([q, p])), expected, rtol=1e-14)
    np.testing.assert_allclose(compiled(surrogate).derivative(0.0, np.array([q, p])), expected, rtol=1e-14)
    assert surrogate.energy(np.array([q, p])) == pytest.approx(0.5 * p * rate + 2.5 * q**2)


def test_where_the_mass_is_not_positive_definite_there_is_no_number():
    surrogate = port_polynomial(6, 4, even=True)
    surrogate.parameters[0] = -1.0
    assert not np.any(np.isfinite(compiled(surrogate).derivative(0.0, random_states(surrogate, 0, 1)[0])))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"floor": -np.ones(6)}, "positive definite"),
        ({"floor": np.ones(3)}, "6 entries"),
        ({"hidden": (3, 3)}, "one hidden layer"),
        ({"activation": "relu"}, "'relu' is not one of"),
        ({"parameters": np.zeros(3)}, "has .* parameters"),
        ({"scaling": FeatureScaling(x=(1.0,) * 6, dx=(1.0,) * 6)}, "canonical scaling"),
    ],
)
def test_what_makes_no_network_is_refused(changes, reason):
    with pytest.raises(ValueError, match=reason):
        replace(port_network(6, 4, "silu"), **changes)


@given(SEEDS)
def test_the_nearest_semidefinite_matrix(seed):
    """Of a semidefinite matrix its factor; of another one that with the negative eigenvalues at zero."""
    matrix = np.random.default_rng(seed).normal(size=(3, 3))
    matrix = matrix + matrix.T
    values, vectors = np.linalg.eigh(matrix)
    factor = lower(semidefinite_factor(matrix), 3)
    nearest = vectors * np.maximum(values, 0.0) @ vectors.T
    np.testing.assert_allclose(factor @ factor.T, nearest, atol=1e-12)


@pytest.mark.parametrize("kind", ["sparse", "mirrored"])
@pytest.mark.parametrize("plane", PLANES, ids=("one plane", "the other"))
def test_mirrored_motion_is_the_mirror_image_of_motion(kind, plane):
    """M(S q) = S M(q) S; springs and dampers of these are none's image, so it is said of M alone."""
    surrogate = PORT_HAMILTONIANS[kind]
    q = np.random.default_rng(7).uniform(-1.0, 1.0, (5, 3))
    image = plane[:, None] * surrogate.scaled_mass(q) * plane
    np.testing.assert_allclose(surrogate.scaled_mass(plane * q), image, rtol=1e-12, atol=1e-14)
    others = PORT_HAMILTONIANS["entries"], PORT_HAMILTONIANS["odd and even"]
    assert not any(np.allclose(other.scaled_mass(plane * q), image, atol=1e-3) for other in others)


def test_an_even_network_is_its_own_mirror_image():
    """M(−q) = M(q): turned around, the field is the same turned around."""
    for kind in ("even network", "even entries"):
        surrogate = PORT_HAMILTONIANS[kind]
        x = random_states(surrogate, 7)
        np.testing.assert_allclose(surrogate.derivative(0.0, -x), -surrogate.derivative(0.0, x), rtol=1e-12)
    other = PORT_HAMILTONIANS["network"]
    assert not np.allclose(other.derivative(0.0, -x), -other.derivative(0.0, x), rtol=1e-3)


def test_few_coefficients_are_not_looked_up_one_by_one():
    """Of a few modes the dense product is the cheaper one, whatever is zero."""
    few = np.zeros((6, 22))
    few[:, 0] = 1.0
    assert not looking_up_pays(few)
    many = np.zeros((36, 495))
    many[:, :20] = 1.0
    assert looking_up_pays(many)
    assert not looking_up_pays(np.ones((36, 495)))
