"""The compiled forms are the NumPy ones to rounding."""

from itertools import cycle

import numpy as np
import pytest
from random_surrogates import HAMILTONIANS, NETWORKS, PORT_HAMILTONIANS, network

from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate
from flexsurr.simulation.rhs import CompiledModel, evaluate
from flexsurr.surrogates import ACTIVATIONS, MLP, Hamiltonian, compiled

SHAPES = [(2, (5,)), (2, (33,)), (6, (10,)), (4, (3, 6, 2))]


def assert_same(surrogate, number=20):
    model = compiled(surrogate)
    assert isinstance(model, CompiledModel)
    count = len(surrogate.state_names)
    reach = 1.0 if surrogate.architecture == "port_hamiltonian" else 2.0
    x = np.random.default_rng(1).uniform(-reach, reach, (number, count)) * surrogate.scaling.states(count)
    expected = surrogate.derivative(0.0, x)
    found = np.array([model.derivative(0.0, state) for state in x])
    assert np.all(np.abs(found - expected) <= 1e-12 * np.max(np.abs(expected), axis=0))


@pytest.mark.parametrize("name", HAMILTONIANS)
def test_hamiltonians(name):
    assert_same(HAMILTONIANS[name])


@pytest.mark.parametrize("name", PORT_HAMILTONIANS)
def test_port_hamiltonians(name):
    assert_same(PORT_HAMILTONIANS[name])


@pytest.mark.parametrize(("activation", "architecture"), [*zip(ACTIVATIONS, cycle(("hnn", "mlp")))])
def test_activations(activation, architecture):
    """With one architecture each, for to compile it takes seconds; what they compute: test_operations.py."""
    assert_same(network(NETWORKS[architecture], 2, (12,), activation))


@pytest.mark.parametrize("architecture", NETWORKS)
@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_shapes(architecture, shape):
    assert_same(network(NETWORKS[architecture], *shape, "squareplus"))


@pytest.mark.parametrize("surrogate", [HAMILTONIANS["two layers"], network(MLP, 4, (6, 3), "atan")])
def test_a_larger_workspace_is_as_good(surrogate):
    model = compiled(surrogate)
    x = 0.3 * surrogate.scaling.states(len(surrogate.state_names))
    dx = np.empty_like(x)
    evaluate(model.kernel, 0.0, x, dx, np.full(model.work_size + 7, np.nan))
    np.testing.assert_array_equal(dx, model.derivative(0.0, x))


def test_only_hamiltonians_have_an_energy():
    hnn, mlp = HAMILTONIANS["one layer"], network(MLP, 2, (4,), "tanh")
    x = np.array([0.1, 1.0])
    assert isinstance(compiled(hnn), Hamiltonian)
    assert compiled(hnn).energy(x) == hnn.energy(x)
    assert not isinstance(compiled(mlp), Hamiltonian)


def test_integrators_take_it():
    """A compiled Hamiltonian keeps its energy along a trajectory, to the integrator's accuracy."""
    model = compiled(HAMILTONIANS["even"])
    t = np.linspace(0.0, 0.02, 6)
    trajectory = simulate(model, t, np.array([0.1, 0.5]), Integrator(method="rk4", step_s=1e-4))
    assert trajectory.completed
    energy = model.energy(trajectory.x)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)
