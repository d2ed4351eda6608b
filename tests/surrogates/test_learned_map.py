"""Learned maps: three implementations, one function; their Jacobians; files that hold them."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

from flexsurr.simulation.mapping import mapping_jacobian
from flexsurr.surrogates import (
    Intervals,
    NetworkMap,
    PolynomialMap,
    SurrogateFileError,
    generalised_force,
    load_map,
    save_map,
)
from flexsurr.surrogates.monomials import monomials_to_degree
from flexsurr.surrogates.network_map import side_by_side
from flexsurr.training.networks import TorchMap, export_error

INPUTS, OUTPUTS = 25, 12


SEEDS = st.integers(0, 2**20)


def intervals(letter: str, low: np.ndarray, width: np.ndarray) -> Intervals:
    return Intervals(tuple(f"{letter}{k}" for k in range(len(low))), low, low + width)


def random_inputs(generator: np.random.Generator, count: int = INPUTS) -> Intervals:
    # ranges of any size, a few times that from zero as Mach numbers and altitudes are: an input far out
    # would lose in its scaling the digits that are compared
    width = 10.0 ** generator.uniform(-3.0, 4.0, count)
    return intervals("u", width * generator.uniform(-4.0, 3.0, count), width)


def random_network(seed: int, hidden: int = 75, activation: str = "tanh") -> NetworkMap:
    generator = np.random.default_rng(seed)
    inputs, low = random_inputs(generator), generator.uniform(-3.0, 3.0, OUTPUTS)
    return NetworkMap(
        inputs,
        intervals("y", low, generator.uniform(0.01, 3.0, OUTPUTS)),
        hidden,
        activation,
        generator.standard_normal(INPUTS * hidden + hidden + hidden * OUTPUTS + OUTPUTS),
    )


def random_polynomial(seed: int) -> PolynomialMap:
    generator = np.random.default_rng(seed)
    exponents = np.concatenate([np.zeros((1, 3), dtype=np.int64), monomials_to_degree(3, 4)])
    coefficients = generator.normal(size=(len(exponents), 5))
    return PolynomialMap(random_inputs(generator, 3), tuple("abcde"), exponents, coefficients)


def with_second_order(plain: NetworkMap, products: tuple[tuple[int, int], ...], seed: int) -> NetworkMap:
    weights, biases, weights_out, biases_out = plain.layers()
    further = np.random.default_rng(seed).standard_normal((len(products), plain.hidden))
    pieces = (np.vstack([weights, further]), biases, weights_out, biases_out)
    return dataclasses.replace(
        plain, parameters=np.concatenate([piece.ravel() for piece in pieces]), products=products
    )


PRODUCTS = ((2, 2), (3, 20), (24, 0))
MAPS = {
    "network": lambda seed: random_network(seed, hidden=7, activation="atan"),
    "second order": lambda seed: with_second_order(random_network(seed, hidden=6), PRODUCTS, seed),
    "polynomial": random_polynomial,
}
EACH = pytest.mark.parametrize("kind", MAPS)


def inputs(learned, seed: int, count: int, beyond: float = 1.0) -> np.ndarray:
    unit = np.random.default_rng(seed).uniform(-beyond, beyond, (count, len(learned.inputs.names)))
    return learned.inputs.origin + learned.inputs.half * unit


@settings(max_examples=20)
@given(seed=SEEDS, beyond=st.sampled_from([0.1, 1.0, 10.0]))
def test_torch_numpy_and_compiled_code_agree(seed, beyond):
    network = random_network(seed)
    u = inputs(network, seed, 20, beyond)
    expected = TorchMap(network)(u)
    # sums of 75 terms of the size of the outputs
    size = 2e-12 * network.outputs.half
    assert np.all(np.abs(network(u) - expected) < size)
    assert np.all(np.abs(network.compiled()(u) - expected) < size)
    assert 0.0 < export_error(network, count=20) < 1e-12


@EACH
def test_compiled_it_is_the_same(kind):
    learned = MAPS[kind](3)
    u = inputs(learned, 4, 6)
    np.testing.assert_allclose(learned.compiled()(u[0]), learned(u)[0], rtol=1e-10, atol=1e-10)
    assert learned.compiled()(u.reshape(2, 3, -1)).shape == (2, 3, len(learned.output_names))


@njit(error_model="numpy")
def evaluate_jacobian(kernel, u, jac, work):
    mapping_jacobian(kernel, u, jac, work)


def test_of_what_has_no_jacobian_there_is_none():
    with pytest.raises(TypeError, match="NetworkMap; call mapping_jacobian from compiled code"):
        mapping_jacobian(random_network(0), np.zeros(25), np.zeros(300), np.zeros(1))


@EACH
def test_compiled_its_jacobian_is_the_same(kind):
    learned = MAPS[kind](5)
    (u,) = inputs(learned, 6, 1)
    function, expected = learned.compiled(), learned.jacobian(u)
    jac = np.empty(expected.size)
    evaluate_jacobian(function.kernel, u, jac, np.full(function.work_size, np.nan))
    np.testing.assert_allclose(jac.reshape(expected.shape), expected, rtol=1e-10, atol=1e-10)


@EACH
@given(seed=SEEDS)
def test_forces_do_the_work_of_the_learned_displacements(kind, seed):
    """∫ Q · dη along a path is F · (r̂(end) − r̂(start)): Gauss–Legendre over a straight path."""
    learned = MAPS[kind](seed)
    generator = np.random.default_rng(seed)
    start, end = inputs(learned, seed, 2, 0.5)
    force = generator.normal(size=len(learned.output_names))
    nodes, weights = np.polynomial.legendre.leggauss(60)
    along = start + 0.5 * (nodes[:, None] + 1.0) * (end - start)
    work = 0.5 * weights @ (generalised_force(learned, along, force) @ (end - start))
    assert work == pytest.approx(force @ (learned(end) - learned(start)), abs=1e-6)


@EACH
def test_saved_and_loaded_it_is_the_same_to_the_bit(kind, tmp_path):
    learned, path = MAPS[kind](1), tmp_path / "map.npz"
    u = inputs(learned, 2, 5)
    save_map(learned, path)
    again = load_map(path)
    assert (type(again), again.inputs.names) == (type(learned), learned.inputs.names)
    assert (again.output_names, again.settings()) == (learned.output_names, learned.settings())
    np.testing.assert_array_equal(again(u), learned(u))


def test_products_of_inputs_are_further_inputs():
    network = with_second_order(random_network(5, hidden=6), PRODUCTS, 6)
    weights, biases, weights_out, biases_out = network.layers()
    u = inputs(network, 7, 20)
    low, high = network.inputs.low, network.inputs.high
    x = (2.0 * u - low - high) / (high - low)
    second = np.stack([x[:, a] * x[:, b] for a, b in PRODUCTS], axis=1)
    hidden = np.tanh(x @ weights[:INPUTS] + second @ weights[INPUTS:] + biases)
    expected = network.outputs.origin + network.outputs.half * (hidden @ weights_out + biases_out)
    for form in (network, network.compiled(), TorchMap(network)):
        np.testing.assert_allclose(form(u), expected, atol=1e-10)


def test_networks_side_by_side_are_one_that_gives_what_each_gives(tmp_path):
    first = random_network(8, hidden=5)
    others = [random_network(seed, hidden=5) for seed in (9, 10)]
    parts = []
    for network, places in zip((first, *others), ([3, 0], [1], [4, 2]), strict=True):
        weights, biases, weights_out, biases_out = network.layers()
        pieces = (weights, biases, weights_out[:, places], biases_out[places])
        parts.append(
            dataclasses.replace(
                network,
                inputs=first.inputs,
                outputs=network.outputs.only([f"y{k}" for k in places]),
                parameters=np.concatenate([piece.ravel() for piece in pieces]),
            )
        )
    joined = side_by_side(parts, tuple(f"y{k}" for k in range(5)))
    save_map(joined, tmp_path / "weights.npz")
    again = load_map(tmp_path / "weights.npz")
    u = inputs(first, 11, 20)
    for part, places in zip(parts, ([3, 0], [1], [4, 2]), strict=True):
        for form in (joined, joined.compiled(), again.compiled()):
            np.testing.assert_allclose(form(u)[:, places], part(u), rtol=1e-12, atol=1e-10)
    reads = joined.compiled().kernel.reads
    assert reads.tolist() == [[0, 5], [5, 10], [10, 15], [0, 5], [10, 15]]


@EACH
def test_files_that_hold_no_map_are_named(kind, tmp_path):
    path, spoilt = tmp_path / "map.npz", tmp_path / "spoilt.npz"
    save_map(MAPS[kind](1), path)
    with np.load(path) as file:
        np.savez(spoilt, **{**file, "input_low": np.full_like(file["input_low"], np.nan)})
    with pytest.raises(SurrogateFileError, match=r"spoilt\.npz: .*input_low that are not finite"):
        load_map(spoilt)
    content = path.read_bytes()
    for size in range(0, len(content), 97):
        path.write_bytes(content[:size])
        with pytest.raises(SurrogateFileError, match=r"map\.npz: "):
            load_map(path)
    foreign = tmp_path / "foreign.npz"
    np.savez(foreign, parameters=np.zeros(3))
    with pytest.raises(SurrogateFileError, match=r"foreign\.npz: not a learned map"):
        load_map(foreign)
    with pytest.raises(FileNotFoundError):
        load_map(tmp_path / "none.npz")


@pytest.mark.parametrize(
    ("kind", "changes", "reason"),
    [
        ("network", {"hidden": 4}, "parameters don't make 25 x 4 x 12 neurons"),
        ("network", {"activation": "relu"}, "'relu' is not one of"),
        ("polynomial", {"output_names": ("x",)}, "do not fit 35 monomials and the outputs x"),
        ("polynomial", {"exponents": np.ones((2, 3), dtype=np.int64)}, "the first monomial must be"),
    ],
)
def test_what_makes_no_map_is_refused(kind, changes, reason):
    with pytest.raises(ValueError, match=reason):
        dataclasses.replace(MAPS[kind](1), **changes)


def test_intervals_that_are_none_are_refused():
    for low, high in (([0.0, 1.0], [1.0, 1.0]), ([0.0], [1.0])):
        with pytest.raises(ValueError, match="each of a, b has an interval, and low < high"):
            Intervals(("a", "b"), np.array(low), np.array(high))
