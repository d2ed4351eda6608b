"""The canonical scaling keeps Hamilton's equations, and no trace of it is left in the physical field."""

from dataclasses import replace

import numpy as np
import pytest
from random_surrogates import SCALING, network, polynomial

from flexsurr.surrogates import HNN, Scaling, canonical_scaling


def test_scaled_samples_are_of_order_one():
    generator = np.random.default_rng(0)
    x = generator.normal(size=(500, 4)) * [0.2, 0.3, 5.0, 1.0]
    dx = generator.normal(size=(500, 4)) * [30.0, 10.0, 100.0, 50.0]
    scaling = canonical_scaling(x, dx)
    scaled, rates = x / scaling.states(4), dx / scaling.rates(4)
    assert np.max(np.abs(scaled[:, :2])) == pytest.approx(1.0)
    assert np.max(np.abs(scaled[:, 2:])) == pytest.approx(1.0)
    mean_squares = np.mean(rates[:, :2] ** 2), np.mean(rates[:, 2:] ** 2)
    assert mean_squares[0] * mean_squares[1] == pytest.approx(1.0)


def test_rates_are_states_over_time():
    np.testing.assert_allclose(SCALING.rates(6), SCALING.states(6) / SCALING.time_s)


def test_scaling_is_only_a_choice_of_units():
    """H in other units is another polynomial with the same field."""
    first = polynomial(4, 4)
    other = Scaling(q=1.3, p=0.7, energy=5.0)
    ratio = other.states(4) / first.scaling.states(4)
    rescaled = first.parameters * np.prod(ratio**first.exponents, axis=1)
    second = replace(first, scaling=other, parameters=rescaled * first.scaling.energy / other.energy)
    x = np.random.default_rng(1).uniform(-1, 1, (10, 4))
    np.testing.assert_allclose(first.derivative(0.0, x), second.derivative(0.0, x), rtol=1e-12)
    np.testing.assert_allclose(first.energy(x), second.energy(x), rtol=1e-12)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_a_scale_is_finite_and_positive(value):
    with pytest.raises(ValueError, match="scale of p"):
        Scaling(q=1.0, p=value, energy=1.0)


def test_weights_must_fit():
    hnn = network(HNN, 2, (4,), "tanh")
    with pytest.raises(ValueError, match="16 parameters"):
        replace(hnn, parameters=np.zeros(17))
    with pytest.raises(ValueError, match="'relu' is not one of elu"):
        replace(hnn, activation="relu")
    with pytest.raises(ValueError, match="hidden layers"):
        replace(hnn, hidden=())
    with pytest.raises(ValueError, match="come in pairs"):
        replace(hnn, state_names=("a",), state_units=("1",))
