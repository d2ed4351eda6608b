"""The network of products is even, whatever its weights."""

from dataclasses import replace

import numpy as np
import pytest
from random_surrogates import even_network

from flexsurr.surrogates import FeatureScaling

EACH = pytest.mark.parametrize("count", [2, 6])


@EACH
def test_energy_is_even_in_coordinates_and_in_momenta(count):
    surrogate = even_network(count, 5, "softplus")
    x = np.random.default_rng(0).uniform(-1.0, 1.0, (20, count)) * surrogate.scaling.states(count)
    for half in (slice(None, count // 2), slice(count // 2, None)):
        turned = x.copy()
        turned[:, half] *= -1.0
        np.testing.assert_array_equal(surrogate.energy(turned), surrogate.energy(x))


@EACH
def test_it_rests_where_it_is_undeformed(count):
    np.testing.assert_array_equal(even_network(count, 5, "atan").derivative(0.0, np.zeros(count)), 0.0)


def test_what_it_cannot_be_is_refused():
    surrogate = even_network(2, 3, "atan")
    with pytest.raises(ValueError, match="canonical"):
        replace(surrogate, scaling=FeatureScaling((1.0, 1.0), (1.0, 1.0)))
    with pytest.raises(ValueError, match="one hidden layer"):
        replace(surrogate, hidden=(3, 3))
    with pytest.raises(ValueError, match="12 parameters"):
        replace(surrogate, parameters=np.zeros(3))
