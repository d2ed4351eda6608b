"""Learned kinematics of two links in a plane, whose positions and Jacobian are known."""

import numpy as np
import pytest

from flexsurr.surrogates import generalised_force
from flexsurr.training import fit_network_map, fit_polynomial_map
from flexsurr.training.map_fitting import coordinates

NAMES = ("x", "z", "sin", "cos")


def outputs(eta):
    """Tip of two links of lengths 1 and 0.5 and the sine and cosine of the last one's angle."""
    first, second = eta[:, 0], eta[:, 0] + eta[:, 1]
    x = np.cos(first) + 0.5 * np.cos(second)
    z = np.sin(first) + 0.5 * np.sin(second)
    return np.stack([x, z, np.sin(second), np.cos(second)], axis=1)


def force(eta, f_x, f_z):
    """Jᵀ F by hand."""
    first, second = eta[:, 0], eta[:, 0] + eta[:, 1]
    of_second = 0.5 * (f_z * np.cos(second) - f_x * np.sin(second))
    return np.stack([f_z * np.cos(first) - f_x * np.sin(first) + of_second, of_second], axis=1)


GENERATOR = np.random.default_rng(0)
ETA, FRESH = (GENERATOR.uniform(-1.0, 1.0, (count, 2)) * [0.9, 1.4] for count in (1500, 200))
INPUTS = coordinates(ETA)
FITS = {
    "polynomial": (lambda: fit_polynomial_map(INPUTS, ETA, outputs(ETA), NAMES, 9), 1e-4),
    "network": (lambda: fit_network_map(INPUTS, ETA, outputs(ETA), NAMES, 16, "atan", 60), 1e-2),
}


@pytest.mark.parametrize("kind", FITS)
def test_positions_and_forces(kind):
    make, tolerance = FITS[kind]
    learned = make()
    np.testing.assert_allclose(learned(FRESH), outputs(FRESH), atol=tolerance)
    found = generalised_force(learned, FRESH, np.array([3.0, -2.0, 0.0, 0.0]))
    np.testing.assert_allclose(found, force(FRESH, 3.0, -2.0), atol=50 * tolerance)


def test_a_polynomial_is_found_to_rounding_in_blocks(monkeypatch):
    truth = fit_polynomial_map(INPUTS, ETA, outputs(ETA), NAMES, 4)
    monkeypatch.setattr("flexsurr.training.map_fitting.BLOCK", 64)
    found = fit_polynomial_map(INPUTS, ETA, truth(ETA), NAMES, 4)
    np.testing.assert_allclose(found.coefficients, truth.coefficients, atol=1e-12)
    one = fit_polynomial_map(INPUTS, ETA, truth(ETA)[:, :1], ("x",), 4)
    np.testing.assert_allclose(one.coefficients[:, 0], truth.coefficients[:, 0], atol=1e-12)


def test_seeds_differ_and_repeat():
    first, again, other = (
        fit_network_map(INPUTS, ETA[:200], outputs(ETA[:200]), NAMES, 4, "tanh", 5, seed)
        for seed in (0, 0, 1)
    )
    np.testing.assert_array_equal(first.parameters, again.parameters)
    assert not np.allclose(first.parameters, other.parameters)


def test_a_coordinate_that_does_not_vary_is_refused():
    with pytest.raises(ValueError, match="coordinate 2 is zero"):
        coordinates(ETA * [1.0, 0.0])


@pytest.mark.parametrize("value", [0.0, 3.0])
def test_an_output_that_does_not_vary_is_a_constant(value):
    """As the force of a load along an axial joint: the others are learned as if it were not there."""
    given = outputs(ETA[:200])
    given[:, 1] = value
    learned = fit_network_map(INPUTS, ETA[:200], given, NAMES, 8, "tanh", 20)
    np.testing.assert_allclose(learned(FRESH)[:, 1], value, atol=1e-12)
    np.testing.assert_allclose(learned(FRESH)[:, 0], outputs(FRESH)[:, 0], atol=0.2)
