"""Ensembles by torch, on the CPU, are those of compiled code."""

from dataclasses import replace

import numpy as np
import pytest

from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate_ensemble
from flexsurr.surrogates import (
    HNN,
    MLP,
    EvenHNN,
    NetworkPortHamiltonian,
    PairScaling,
    PolynomialHamiltonian,
    PolynomialPortHamiltonian,
    Scaling,
)
from flexsurr.surrogates.monomials import monomials_to_degree
from flexsurr.surrogates.packed import pack
from flexsurr.surrogates.potential import Potential
from flexsurr.training import on_device
from flexsurr.training.on_device import rates_on_device, simulate_on_device

torch = pytest.importorskip("torch")

ONE = {"state_names": ("eta_1", "p_1"), "state_units": ("1", "1")}
TWO = {"state_names": ("eta_1", "eta_2", "p_1", "p_2"), "state_units": ("1",) * 4}
SCALING, PAIRS = Scaling(0.6, 6.0, 40.0), PairScaling((0.6, 2.0), 3.6, 40.0)


def weights(count, spread=1.0):
    return spread * np.random.default_rng(0).normal(size=count)


def port_polynomial():
    exponents = np.concatenate([np.zeros((1, 2), dtype=np.int64), monomials_to_degree(2, 3)])
    mass = weights(3 * len(exponents), 0.02).reshape(3, -1)
    mass[:, 0] += pack(np.eye(2))
    parameters = np.concatenate([mass.ravel(), [2.0, 0.3, 1.0], [0.3, 0.1, 0.2]])
    return PolynomialPortHamiltonian(parameters, PAIRS, **TWO, exponents=exponents)


def port_network(even, factored=True):
    count = sum(int(np.prod(shape)) for shape in NetworkPortHamiltonian.shapes(2, 4, even))
    return NetworkPortHamiltonian(
        weights(count, 0.5 if factored else 0.1), PAIRS, **TWO,
        floor=pack((0.1 if factored else 1.0) * np.eye(2) + 0.01),
        even=even, hidden=(4,), activation="softplus", factored=factored,
    )  # fmt: skip


POTENTIAL = Potential(np.array([[1, 0], [2, 1], [0, 4]]), np.array([0.3, -0.2, 0.5]))
EXPONENTS = np.array([[2, 0], [0, 2], [2, 2], [4, 0]])
POLYNOMIAL = PolynomialHamiltonian(np.array([1.0, 1.0, 0.2, 0.3]), SCALING, **ONE, exponents=EXPONENTS)
SURROGATES = {
    "hnn": HNN(weights(20), SCALING, **ONE, hidden=(5,), activation="half_log"),
    "mlp": MLP(weights(27), SCALING, **ONE, hidden=(5,), activation="tanh"),
    "even hnn": EvenHNN(weights(24), PAIRS, **TWO, hidden=(3,), activation="atan"),
    "polynomial": POLYNOMIAL,
    "port-Hamiltonian polynomial": port_polynomial(),
    "port-Hamiltonian network": port_network(even=False),
    "even port-Hamiltonian network": port_network(even=True),
    "port-Hamiltonian network of entries": port_network(even=False, factored=False),
    "even port-Hamiltonian network of entries": port_network(even=True, factored=False),
    "port-Hamiltonian polynomial with a potential": replace(port_polynomial(), potential=POTENTIAL),
}
STEP = Integrator(method="dop853_fixed", step_s=0.002)
T = np.array([0.0, 0.005, 0.02])


@pytest.mark.parametrize("surrogate", SURROGATES.values(), ids=SURROGATES)
def test_rates(surrogate):
    count = len(surrogate.state_names)
    x = np.random.default_rng(1).uniform(-1.0, 1.0, (20, count)) * surrogate.scaling.states(count)
    found = rates_on_device(surrogate, torch.device("cpu"))(torch.from_numpy(x)).numpy()
    expected = surrogate.derivative(0.0, x)
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


class Numpy:
    """A surrogate without its compiled form: SciPy steps it."""

    breakpoints = ()
    state_names, state_units = ONE["state_names"], ONE["state_units"]
    derivative = POLYNOMIAL.derivative


def test_an_ensemble(monkeypatch):
    monkeypatch.setattr(on_device, "BLOCK", 3)
    x0 = np.random.default_rng(1).uniform(-1.0, 1.0, (5, 2)) * SCALING.states(2)
    x0[1] = [1e60, 0.0]
    found = simulate_on_device(POLYNOMIAL, T, x0, STEP, "cpu")
    assert np.flatnonzero(~found.completed).tolist() == [1]
    assert np.isnan(found.kept[1, 1:]).all()
    tight = Integrator(method="scipy_dop853", rtol=1e-11, atol=1e-12)
    sound = [0, 2, 3, 4]
    expected = simulate_ensemble(Numpy(), T, x0[sound], tight).kept
    np.testing.assert_allclose(found.kept[sound], expected, atol=1e-9 * np.abs(expected).max())
    ends = simulate_on_device(POLYNOMIAL, T, x0, STEP, "cpu", observe=lambda numbers, x: x[:, -1])
    np.testing.assert_array_equal(ends.kept, found.kept[:, -1])


def test_what_it_cannot_do_is_said():
    with pytest.raises(ValueError, match="device: radau_iia_5 does not run on one; allowed: rk4, dop853"):
        simulate_on_device(POLYNOMIAL, T, np.ones((1, 2)), Integrator(method="radau_iia_5"), "cpu")
    with pytest.raises(ValueError, match="device: 'abacus' is not allowed; allowed: cpu"):
        simulate_on_device(POLYNOMIAL, T, np.ones((1, 2)), STEP, "abacus")
