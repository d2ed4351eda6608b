"""Potentials beside a mass matrix: an exact gradient, passive, the same compiled, and kept."""

from dataclasses import replace

import numpy as np
import pytest
from random_surrogates import PORT_HAMILTONIANS

from flexsurr.surrogates import compiled, load, save
from flexsurr.surrogates.monomials import monomials_to_degree
from flexsurr.surrogates.potential import Potential

GENERATOR = np.random.default_rng(5)
EXPONENTS = monomials_to_degree(3, 5)
POTENTIAL = Potential(EXPONENTS, GENERATOR.normal(size=len(EXPONENTS)))
THREE = {name: model for name, model in PORT_HAMILTONIANS.items() if model.pairs == 3}


@pytest.fixture(params=THREE)
def surrogate(request):
    return replace(THREE[request.param], potential=POTENTIAL)


def states(surrogate, count=20):
    scales = surrogate.scaling.states(len(surrogate.state_names))
    return 0.5 * scales * GENERATOR.uniform(-1.0, 1.0, (count, scales.size))


def test_its_gradient_is_the_derivative():
    q = GENERATOR.uniform(-1.0, 1.0, (7, 3))
    for j in range(3):
        step = 1e-30j * np.eye(3)[j]
        np.testing.assert_allclose(
            POTENTIAL.gradient(q)[:, j], POTENTIAL.value(q + step).imag / 1e-30, rtol=1e-12, atol=1e-13
        )
    assert POTENTIAL.value(np.zeros(3)) == 0.0


def test_its_springs_and_the_rest_are_the_whole():
    springs, rest = POTENTIAL.split()
    q = GENERATOR.uniform(-1.0, 1.0, (7, 3))
    assert np.linalg.eigvalsh(springs).min() > -1e-12
    whole = 0.5 * np.einsum("si,ij,sj->s", q, springs, q) + rest.value(q)
    np.testing.assert_allclose(whole, POTENTIAL.value(q), atol=1e-13)


def test_energy_never_grows_and_falls_as_the_dampers_take_it(surrogate):
    """dH/dt = ∇H · ẋ = −q̇ᵀ C q̇, by central differences of the energy along the field."""
    for x in states(surrogate):
        dx = surrogate.derivative(0.0, x)
        step = 1e-6 * np.linalg.norm(x) / np.linalg.norm(dx)
        change = (surrogate.energy(x + step * dx) - surrogate.energy(x - step * dx)) / (2.0 * step)
        rates = dx[:3]
        lost = rates @ surrogate.damping @ rates
        scale = np.abs(surrogate.energy(x)) * np.linalg.norm(dx) / np.linalg.norm(x) + lost
        assert change == pytest.approx(-lost, abs=1e-6 * scale)


def test_it_acts_beside_the_rest(surrogate):
    """ṗ is less by ∂V/∂q, q̇ as without it; the energy more by V."""
    without = replace(surrogate, potential=None)
    x = states(surrogate)
    of_q = surrogate.scaling.states(6)[:3]
    added = surrogate.derivative(0.0, x) - without.derivative(0.0, x)
    np.testing.assert_allclose(added[:, :3], 0.0, atol=1e-12)
    force = -POTENTIAL.gradient(x[:, :3] / of_q) * surrogate.scaling.energy / of_q
    np.testing.assert_allclose(added[:, 3:], force, rtol=1e-9, atol=1e-9 * np.abs(force).max())
    value = surrogate.scaling.energy * POTENTIAL.value(x[:, :3] / of_q)
    np.testing.assert_allclose(surrogate.energy(x) - without.energy(x), value, rtol=1e-9)


def test_compiled_it_is_the_same(surrogate):
    model = compiled(surrogate)
    for x in states(surrogate, 5):
        expected = surrogate.derivative(0.0, x)
        np.testing.assert_allclose(
            model.derivative(0.0, x), expected, rtol=1e-9, atol=1e-10 * np.abs(expected).max()
        )


def test_it_is_kept(surrogate, tmp_path):
    save(surrogate, tmp_path / "weights.npz")
    again, x = load(tmp_path / "weights.npz"), states(surrogate)
    np.testing.assert_array_equal(again.derivative(0.0, x), surrogate.derivative(0.0, x))
    np.testing.assert_array_equal(again.energy(x), surrogate.energy(x))


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="degree 1 or more"):
        Potential(np.zeros((1, 3), dtype=np.int64), np.ones(1))
    with pytest.raises(ValueError, match="as many coefficients"):
        Potential(EXPONENTS, np.ones(3))
    one = Potential(np.array([[1]]), np.ones(1))
    with pytest.raises(ValueError, match="a potential of 1 coordinates for 3"):
        replace(next(iter(THREE.values())), potential=one)
