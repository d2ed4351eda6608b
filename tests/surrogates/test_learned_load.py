"""Learned kinematics and the loads made of them: virtual work, and the same compiled."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_surrogates import HAMILTONIANS, PORT_HAMILTONIANS, network

from flexsurr.config.load import Constant, Sine
from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate
from flexsurr.surrogates import (
    HNN,
    LearnedLoad,
    NetworkMap,
    PolynomialMap,
    SurrogateFileError,
    compiled,
    load_map,
    save_map,
)
from flexsurr.surrogates.monomials import monomials_to_degree

NAMES = ("x", "y", "z", "sin", "cos")
SEEDS = st.integers(0, 2**32 - 1)
SCALES = np.array([0.4, 2.0, 0.1])


SINE = Sine(start_s=0.1, end_s=0.7, frequency_rad_s=9.0, phase_rad=0.3)


def polynomial(seed=0):
    exponents = np.concatenate([np.zeros((1, 3), dtype=np.int64), monomials_to_degree(3, 4)])
    coefficients = np.random.default_rng(seed).normal(size=(len(exponents), 5))
    return PolynomialMap(SCALES, NAMES, exponents, coefficients)


def network_map(seed=0):
    generator = np.random.default_rng(seed)
    shapes = (3, 6), (6,), (6, 5), (5,)
    return NetworkMap(SCALES, NAMES, "atan", *(generator.normal(size=shape) for shape in shapes))


MAPS = {"polynomial": polynomial, "network": network_map}
EACH = pytest.mark.parametrize("kind", MAPS)


@EACH
@given(seed=SEEDS)
def test_forces_do_the_work_of_the_learned_displacements(kind, seed):
    """∫ Q · dη along a path is F · (r̂(end) − r̂(start)): Gauss–Legendre over a straight path."""
    learned = MAPS[kind](seed)
    generator = np.random.default_rng(seed)
    start, end = generator.uniform(-0.7, 0.7, (2, 3)) * SCALES
    force = generator.normal(size=5)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    along = start + 0.5 * (nodes[:, None] + 1.0) * (end - start)
    work = 0.5 * weights @ (learned.generalised_force(along, force) @ (end - start))
    assert work == pytest.approx(force @ (learned(end) - learned(start)), abs=1e-6)


def forces(kind, seed=0):
    """A map of three coordinates to three forces."""
    names = ("Q1", "Q2", "Q3")
    if kind == "network":
        generator = np.random.default_rng(seed)
        shapes = (3, 6), (6,), (6, 3), (3,)
        return NetworkMap(SCALES, names, "atan", *(generator.normal(size=shape) for shape in shapes))
    whole = polynomial(seed)
    kept = whole.exponents.sum(axis=1) % 2 == 0 if kind == "even polynomial" else slice(None)
    return PolynomialMap(SCALES, names, whole.exponents[kept], whole.coefficients[kept, :3])


@pytest.mark.parametrize("kind", ["polynomial", "even polynomial", "network"])
def test_compiled_it_adds_the_forces_while_they_act(kind):
    learned = forces(kind)
    model = compiled(PORT_HAMILTONIANS["even"])
    loaded = LearnedLoad(model, learned, SINE)
    assert loaded.breakpoints == (0.1, 0.7)
    assert (loaded.state_names, loaded.state_units) == (model.state_names, model.state_units)
    x = np.concatenate([0.5 * SCALES, [0.3, -1.0, 2.0]])
    np.testing.assert_allclose(loaded.energy(x), model.energy(x))
    for t, factor in ((0.0, 0.0), (0.1, np.sin(1.2)), (0.4, np.sin(3.9)), (0.7, 0.0), (2.0, 0.0)):
        added = loaded.derivative(t, x) - model.derivative(t, x)
        np.testing.assert_allclose(added[:3], 0.0)
        np.testing.assert_allclose(added[3:], factor * learned(x[:3]), rtol=1e-10, atol=1e-9)


def test_it_works_on_what_it_loads():
    """The energy that an undamped model gains is ∫ Q dη: here of forces with a known potential."""
    exponents = np.array([[0], [1], [2]])
    learned = PolynomialMap(np.array([0.3]), ("Q1",), exponents, np.array([[5.0], [-4.0], [4.5]]))

    def potential(eta):
        s = eta / 0.3
        return 0.3 * (5.0 * s - 2.0 * s**2 + 1.5 * s**3)

    model = LearnedLoad(compiled(HAMILTONIANS["even"]), learned, Constant())
    assert model.breakpoints == (0.0,)
    t = np.linspace(0.0, 0.01, 5)
    x = simulate(model, t, np.array([0.1, 0.5]), Integrator(method="rk4", step_s=5e-5)).x
    balance = model.energy(x) - potential(x[:, 0])
    np.testing.assert_allclose(balance, balance[0], rtol=1e-8)
    assert abs(model.energy(x[-1]) - model.energy(x[0])) > 1e-3


@EACH
def test_round_trip_and_damage(kind, tmp_path):
    learned, path = MAPS[kind](), tmp_path / "map.npz"
    save_map(learned, path)
    loaded = load_map(path)
    eta = 0.5 * SCALES
    assert (type(loaded), loaded.output_names) == (type(learned), learned.output_names)
    np.testing.assert_array_equal(loaded(eta), learned(eta))
    spoilt = tmp_path / "spoilt.npz"
    with np.load(path) as file:
        np.savez(spoilt, **{**file, "scales": np.full_like(file["scales"], np.nan)})
    with pytest.raises(SurrogateFileError, match=r"spoilt\.npz: .*scales that are not finite"):
        load_map(spoilt)
    content = path.read_bytes()
    for size in range(0, len(content), 97):
        path.write_bytes(content[:size])
        with pytest.raises(SurrogateFileError, match=r"map\.npz: "):
            load_map(path)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"output_names": ("x",)}, "5 outputs do not fit"),
        ({"scales": np.array([1.0, 0.0, 1.0])}, "must be positive"),
        ({"activation": "relu"}, "'relu' is not one of"),
        ({"biases": np.zeros(2)}, "do not fit 2 neurons"),
    ],
)
def test_what_makes_no_map_is_refused(changes, reason):
    with pytest.raises(ValueError, match=reason):
        replace(network_map(), **changes)


def test_loads_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="3 coordinates to 5 forces does not fit the states"):
        LearnedLoad(compiled(network(HNN, 6, (3,), "atan")), polynomial(), SINE)
    with pytest.raises(ValueError, match="3 coordinates to 3 forces does not fit the states"):
        LearnedLoad(compiled(HAMILTONIANS["even"]), forces("network"), SINE)
