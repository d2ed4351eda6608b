"""The network of coefficients: three implementations, one function; files that hold it."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexsurr.surrogates.archive import SurrogateFileError
from flexsurr.surrogates.coefficient_network import (
    CoefficientNetwork,
    load_coefficient_network,
    save_coefficient_network,
    side_by_side,
)
from flexsurr.training.coefficient_torch import TorchCoefficients, export_error

INPUTS, OUTPUTS = 25, 12


def random_network(seed: int, hidden: int = 75, activation: str = "tanh") -> CoefficientNetwork:
    generator = np.random.default_rng(seed)
    # ranges of any size, a few times that from zero as Mach numbers and altitudes are: an input far out
    # would lose in its scaling the digits that are compared
    width = 10.0 ** generator.uniform(-3.0, 4.0, INPUTS)
    low, output_low = width * generator.uniform(-4.0, 3.0, INPUTS), generator.uniform(-3.0, 3.0, OUTPUTS)
    return CoefficientNetwork(
        parameters=generator.standard_normal(INPUTS * hidden + hidden + hidden * OUTPUTS + OUTPUTS),
        hidden=hidden,
        activation=activation,
        input_low=low,
        input_high=low + width,
        output_low=output_low,
        output_high=output_low + generator.uniform(0.01, 3.0, OUTPUTS),
        input_names=tuple(f"u{k}" for k in range(INPUTS)),
        output_names=tuple(f"y{k}" for k in range(OUTPUTS)),
    )


def inputs(network: CoefficientNetwork, seed: int, count: int, beyond: float = 1.0) -> np.ndarray:
    unit = np.random.default_rng(seed).uniform(-beyond, beyond, (count, INPUTS))
    middle, half = network.input_low + network.input_high, network.input_high - network.input_low
    return 0.5 * (middle + half * unit)


@settings(max_examples=20)
@given(seed=st.integers(0, 2**20), beyond=st.sampled_from([0.1, 1.0, 10.0]))
def test_torch_numpy_and_compiled_code_agree(seed, beyond):
    network = random_network(seed)
    u = inputs(network, seed, 20, beyond)
    scale = network.output_high - network.output_low
    expected = TorchCoefficients(network)(u)
    # sums of 75 terms of the size of the outputs
    size = 1e-12 * scale
    assert np.all(np.abs(network(u) - expected) < size)
    assert np.all(np.abs(network.compiled()(u) - expected) < size)
    assert 0.0 < export_error(network, count=20) < 1e-12


@pytest.mark.parametrize("activation", ["tanh", "atan"])
def test_saved_and_loaded_it_is_the_same_to_the_bit(tmp_path, activation):
    network = random_network(1, hidden=7, activation=activation)
    u = inputs(network, 2, 5)
    save_coefficient_network(network, tmp_path / "weights.npz")
    again = load_coefficient_network(tmp_path / "weights.npz")
    np.testing.assert_array_equal(again(u), network(u))
    assert (again.input_names, again.activation) == (network.input_names, activation)


def test_products_of_features_are_further_inputs():
    plain = random_network(5, hidden=6)
    products = ((2, 2), (3, 20), (24, 0))
    generator = np.random.default_rng(6)
    weights, biases, weights_out, biases_out = plain.arrays()
    further = generator.standard_normal((len(products), 6))
    pieces = (np.vstack([weights, further]), biases, weights_out, biases_out)
    network = dataclasses.replace(
        plain, parameters=np.concatenate([piece.ravel() for piece in pieces]), products=products
    )
    u = inputs(network, 7, 20)
    x = (2.0 * u - network.input_low - network.input_high) / (network.input_high - network.input_low)
    second = np.stack([x[:, a] * x[:, b] for a, b in products], axis=1)
    hidden = np.tanh(x @ weights + second @ further + biases)
    half = 0.5 * (network.output_high - network.output_low)
    expected = 0.5 * (network.output_low + network.output_high) + half * (hidden @ weights_out + biases_out)
    np.testing.assert_allclose(network(u), expected, atol=1e-10)
    np.testing.assert_allclose(network.compiled()(u), expected, atol=1e-10)
    np.testing.assert_allclose(TorchCoefficients(network)(u), expected, atol=1e-10)


def test_networks_side_by_side_are_one_that_gives_what_each_gives(tmp_path):
    first = random_network(8, hidden=5)
    others = [random_network(seed, hidden=5) for seed in (9, 10)]
    shared = {name: getattr(first, name) for name in ("input_low", "input_high")}
    parts = []
    for network, outputs in zip((first, *others), ((3, 0), (1,), (4, 2)), strict=True):
        weights, biases, weights_out, biases_out = network.arrays()
        places = list(range(len(outputs)))
        pieces = (weights, biases, weights_out[:, places], biases_out[places])
        parts.append(
            dataclasses.replace(
                network,
                **shared,
                parameters=np.concatenate([piece.ravel() for piece in pieces]),
                output_low=network.output_low[places],
                output_high=network.output_high[places],
                output_names=tuple(f"y{k}" for k in outputs),
            )
        )
    joined = side_by_side(parts, tuple(f"y{k}" for k in range(5)))
    save_coefficient_network(joined, tmp_path / "weights.npz")
    again = load_coefficient_network(tmp_path / "weights.npz")
    u = inputs(first, 11, 20)
    for part, places in zip(parts, ([3, 0], [1], [4, 2]), strict=True):
        for form in (joined, joined.compiled(), again.compiled()):
            np.testing.assert_allclose(form(u)[:, places], part(u), rtol=1e-12, atol=1e-10)
    reads = joined.compiled().kernel.reads
    assert reads.tolist() == [[0, 5], [5, 10], [10, 15], [0, 5], [10, 15]]


def test_a_single_sample_or_a_grid_of_them():
    network = random_network(3, hidden=4)
    u = inputs(network, 4, 6)
    np.testing.assert_allclose(network.compiled()(u[0]), network(u)[0], rtol=1e-10, atol=1e-12)
    assert network.compiled()(u.reshape(2, 3, -1)).shape == (2, 3, OUTPUTS)


def test_files_that_hold_no_network_are_named(tmp_path):
    damaged = tmp_path / "damaged.npz"
    save_coefficient_network(random_network(1, hidden=3), damaged)
    damaged.write_bytes(damaged.read_bytes()[:200])
    with pytest.raises(SurrogateFileError, match=r"damaged\.npz: not a readable"):
        load_coefficient_network(damaged)
    foreign = tmp_path / "foreign.npz"
    np.savez(foreign, parameters=np.zeros(3))
    with pytest.raises(SurrogateFileError, match=r"foreign\.npz: not a coefficient network"):
        load_coefficient_network(foreign)
    with pytest.raises(FileNotFoundError):
        load_coefficient_network(tmp_path / "none.npz")


def test_arrays_that_do_not_fit_are_refused():
    network = random_network(1, hidden=3)
    good = {name: getattr(network, name) for name in network.__dataclass_fields__}
    with pytest.raises(ValueError, match="neurons"):
        CoefficientNetwork(**{**good, "hidden": 4})
    with pytest.raises(ValueError, match="low < high"):
        CoefficientNetwork(**{**good, "input_high": network.input_low})
    with pytest.raises(ValueError, match="relu"):
        CoefficientNetwork(**{**good, "activation": "relu"})
