"""A model under learned loads: what they add, and the work that they do."""

import numpy as np
import pytest
from random_surrogates import HAMILTONIANS, PORT_HAMILTONIANS, network

from flexsurr.config.history import Constant, Ramp, Sine
from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate
from flexsurr.simulation.history import factor as factor_of
from flexsurr.surrogates import HNN, Intervals, LearnedLoad, NetworkMap, PolynomialMap, compiled
from flexsurr.surrogates.monomials import monomials_to_degree

SCALES = np.array([0.4, 2.0, 0.1])
ETA = Intervals(("eta_1", "eta_2", "eta_3"), -SCALES, SCALES)
SINE = Sine(start_s=0.1, end_s=0.7, frequency_rad_s=9.0, phase_rad=0.3)


def forces(kind, outputs=3):
    """A map of three coordinates to as many forces, or another number of them."""
    names, generator = tuple(f"Q{k + 1}" for k in range(outputs)), np.random.default_rng(0)
    if kind == "network":
        largest = generator.uniform(0.5, 2.0, outputs)
        parameters = generator.normal(size=3 * 6 + 6 + 6 * outputs + outputs)
        return NetworkMap(ETA, Intervals(names, -largest, largest), 6, "atan", parameters)
    exponents = np.concatenate([np.zeros((1, 3), dtype=np.int64), monomials_to_degree(3, 4)])
    if kind == "even polynomial":
        exponents = exponents[exponents.sum(axis=1) % 2 == 0]
    return PolynomialMap(ETA, names, exponents, generator.normal(size=(len(exponents), outputs)))


@pytest.mark.parametrize("kind", ["polynomial", "even polynomial", "network"])
def test_compiled_it_adds_the_forces_while_they_act(kind):
    learned = forces(kind)
    model = compiled(PORT_HAMILTONIANS["even"])
    loaded = LearnedLoad(model, learned, (SINE,))
    assert loaded.breakpoints == (0.1, 0.7)
    assert (loaded.state_names, loaded.state_units) == (model.state_names, model.state_units)
    x = np.concatenate([0.5 * SCALES, [0.3, -1.0, 2.0]])
    np.testing.assert_allclose(loaded.energy(x), model.energy(x))
    for t, factor in ((0.0, 0.0), (0.1, np.sin(1.2)), (0.4, np.sin(3.9)), (0.7, 0.0), (2.0, 0.0)):
        added = loaded.derivative(t, x) - model.derivative(t, x)
        np.testing.assert_allclose(added[:3], 0.0)
        np.testing.assert_allclose(added[3:], factor * learned(x[:3]), rtol=1e-10, atol=1e-9)


def test_forces_of_several_loads_add_up_each_with_its_history():
    model, learned = compiled(PORT_HAMILTONIANS["even"]), forces("polynomial", 6)
    ramp = Ramp(start_s=0.2, rise_s=0.4)
    loaded = LearnedLoad(model, learned, (SINE, ramp))
    assert loaded.breakpoints == (0.1, 0.2, pytest.approx(0.6), 0.7)
    x = np.concatenate([0.5 * SCALES, [0.3, -1.0, 2.0]])
    for t in (0.0, 0.15, 0.3, 0.65, 0.9):
        both = factor_of(SINE, t) * learned(x[:3])[:3] + factor_of(ramp, t) * learned(x[:3])[3:]
        added = loaded.derivative(t, x) - model.derivative(t, x)
        np.testing.assert_allclose(added[3:], both, rtol=1e-10, atol=1e-9)


def test_it_works_on_what_it_loads():
    """The energy that an undamped model gains is ∫ Q dη: here of forces with a known potential."""
    exponents = np.array([[0], [1], [2]])
    inputs = Intervals(("eta_1",), np.array([-0.3]), np.array([0.3]))
    learned = PolynomialMap(inputs, ("Q1",), exponents, np.array([[5.0], [-4.0], [4.5]]))

    def potential(eta):
        s = eta / 0.3
        return 0.3 * (5.0 * s - 2.0 * s**2 + 1.5 * s**3)

    model = LearnedLoad(compiled(HAMILTONIANS["even"]), learned, (Constant(),))
    assert model.breakpoints == (0.0,)
    t = np.linspace(0.0, 0.01, 5)
    x = simulate(model, t, np.array([0.1, 0.5]), Integrator(method="rk4", step_s=5e-5)).x
    balance = model.energy(x) - potential(x[:, 0])
    np.testing.assert_allclose(balance, balance[0], rtol=1e-8)
    assert abs(model.energy(x[-1]) - model.energy(x[0])) > 1e-3


def test_loads_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match=r"3 coordinates to 5 forces of 1 load\(s\) does not fit the states"):
        LearnedLoad(compiled(network(HNN, 6, (3,), "atan")), forces("polynomial", 5), (SINE,))
    with pytest.raises(ValueError, match=r"3 coordinates to 3 forces of 1 load\(s\) does not fit the states"):
        LearnedLoad(compiled(HAMILTONIANS["even"]), forces("network"), (SINE,))
