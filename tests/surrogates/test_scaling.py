"""The canonical scaling keeps Hamilton's equations, and no trace of it is left in the physical field."""

from dataclasses import replace

import numpy as np
import pytest
from random_surrogates import PAIRS, SCALING, network, polynomial

from flexsurr.storage import Scales
from flexsurr.surrogates import (
    HNN,
    MLP,
    DissipativeHNN,
    FeatureScaling,
    PairScaling,
    Scaling,
    canonical_scaling,
    compiled,
    feature_scaling,
    load,
    pair_scaling,
    save,
)


def test_scaled_samples_are_of_order_one():
    generator = np.random.default_rng(0)
    x = generator.normal(size=(500, 4)) * [0.2, 0.3, 5.0, 1.0]
    dx = generator.normal(size=(500, 4)) * [30.0, 10.0, 100.0, 50.0]
    scaling = canonical_scaling(Scales.of(x, dx))
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


FEATURES = FeatureScaling(x=(0.6, 2.0, 0.1, 3.0, 1.0, 5.0), dx=(30.0, 40.0, 9.0, 70.0, 80.0, 20.0))


def test_scales_by_pair_are_canonical():
    """Each s_q,k s_ṗ,k and s_p,k s_q̇,k is the scale of the energy; equal ones are the plain scaling."""
    q, p = np.split(PAIRS.states(6), 2)
    dq, dp = np.split(PAIRS.rates(6), 2)
    np.testing.assert_allclose([q * dp, p * dq], PAIRS.energy)
    equal = PairScaling(q=(SCALING.q,) * 3, action=SCALING.q * SCALING.p, energy=SCALING.energy)
    np.testing.assert_allclose(equal.states(6), SCALING.states(6))
    np.testing.assert_allclose(equal.rates(6), SCALING.rates(6))
    with pytest.raises(ValueError, match="3 scales do not fit 2"):
        PAIRS.states(4)


def test_scales_of_samples_by_pair_and_by_feature():
    generator = np.random.default_rng(0)
    x = generator.normal(size=(500, 4)) * [0.2, 0.03, 5.0, 1.0]
    dx = generator.normal(size=(500, 4)) * [30.0, 10.0, 100.0, 50.0]
    scaled = x / pair_scaling(Scales.of(x, dx)).states(4)
    np.testing.assert_allclose(np.max(np.abs(scaled[:, :2]), axis=0), 1.0)
    assert np.max(np.abs(scaled[:, 2:])) == pytest.approx(1.0)
    scaling = feature_scaling(Scales.of(x, dx))
    np.testing.assert_allclose(np.std(x / scaling.states(4), axis=0), 1.0)
    np.testing.assert_allclose(np.std(dx / scaling.rates(4), axis=0), 1.0)
    with pytest.raises(ValueError, match="scale of x_2"):
        feature_scaling(Scales.of(x * [1.0, 0.0, 1.0, 1.0], dx))
    with pytest.raises(ValueError, match="scale of q"):
        pair_scaling(Scales.of(x * [1.0, 0.0, 1.0, 1.0], dx))


def test_scalings_of_scales_are_those_of_the_samples():
    """Each number by its definition, of samples whose means are not zero."""
    generator = np.random.default_rng(3)
    x = generator.normal(0.7, 1.0, (300, 4)) * [0.2, 0.03, 5.0, 1.0]
    dx = generator.normal(-2.0, 1.0, (300, 4)) * [30.0, 10.0, 100.0, 50.0]
    scales = Scales.of(x, dx)
    (q_1, q_2, p_1, p_2), rms = np.max(np.abs(x), axis=0), lambda values: np.sqrt(np.mean(values**2))
    plain, pairs, features = canonical_scaling(scales), pair_scaling(scales), feature_scaling(scales)
    assert (plain.q, plain.p) == (max(q_1, q_2), max(p_1, p_2))
    assert plain.energy**2 == pytest.approx(plain.p * rms(dx[:, :2]) * plain.q * rms(dx[:, 2:]), rel=1e-14)
    assert pairs.q == (q_1, q_2)
    assert pairs.action == max(q_1 * p_1, q_2 * p_2)
    assert pairs.energy / pairs.action == pytest.approx(rms(dx[:, :2] / [q_1, q_2]), rel=1e-14)
    np.testing.assert_allclose([features.x, features.dx], [np.std(x, axis=0), np.std(dx, axis=0)], rtol=1e-14)


def test_a_canonical_scaling_by_feature_is_the_plain_one():
    features = FeatureScaling(x=tuple(SCALING.states(6)), dx=tuple(SCALING.rates(6)))
    assert features.energy == pytest.approx(SCALING.energy)
    hnn = network(HNN, 6, (4,), "atan")
    other = replace(hnn, scaling=features)
    x = np.random.default_rng(1).uniform(-1, 1, (10, 6)) * SCALING.states(6)
    np.testing.assert_allclose(other.derivative(0.0, x), hnn.derivative(0.0, x), rtol=1e-12)
    np.testing.assert_allclose(other.energy(x), hnn.energy(x), rtol=1e-12)


@pytest.mark.parametrize("form", [HNN, MLP, DissipativeHNN])
@pytest.mark.parametrize("scaling", [PAIRS, FEATURES], ids=["pairs", "features"])
def test_kernels_and_files_keep_other_scalings(form, scaling, tmp_path):
    surrogate = replace(network(form, 6, (4,), "atan"), scaling=scaling)
    save(surrogate, tmp_path / "weights.npz")
    loaded = load(tmp_path / "weights.npz")
    assert loaded.scaling == scaling
    x = np.random.default_rng(1).uniform(-1, 1, (5, 6)) * scaling.states(6)
    expected = scaling.rates(6) * surrogate.scaled_field(x / scaling.states(6))
    model = compiled(loaded)
    found = np.array([model.derivative(0.0, state) for state in x])
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12 * np.max(np.abs(expected)))
