"""What a compiled right-hand side takes, counted by running its source."""

import numpy as np
import pytest

from flexsurr.beam import full_order, reduce, reduced_order
from flexsurr.config.structure import Structure
from flexsurr.config.study import Reduction
from flexsurr.evaluation.operations import LIBRARY, counted_outputs, counted_rates, operations
from flexsurr.simulation.python_kernel import PythonEquations
from flexsurr.surrogates import (
    ACTIVATIONS,
    HNN,
    MLP,
    EvenHNN,
    PolynomialHamiltonian,
    PolynomialMap,
    Scaling,
    compiled,
)
from flexsurr.surrogates.learned_map import Intervals
from flexsurr.surrogates.monomials import monomials_to_degree

SCALING = Scaling(q=0.6, p=6.0, energy=40.0)
PAIR = {"state_names": ("q", "p"), "state_units": ("1", "kg m2/s")}
START = np.array([0.3, 2.0])


def beam(elements: int) -> Structure:
    return Structure(
        name="beam",
        length_m=1.0,
        elements=elements,
        joints=("out_of_plane",),
        mass_per_length_kg_m=0.2,
        bending_stiffness_out_of_plane_N_m2=50.0,
    )


def network(form, neurons, activation):
    size = sum(int(np.prod(shape)) for shape in form.shapes(2, neurons if form is EvenHNN else (neurons,)))
    weights = np.random.default_rng(0).normal(size=size)
    return form(weights, SCALING, **PAIR, hidden=(neurons,), activation=activation)


def polynomial(degree):
    exponents = monomials_to_degree(2, degree)
    even = (exponents[:, 0] % 2 == 0) & np.isin(exponents[:, 1], (0, 2))
    coefficients = np.random.default_rng(0).normal(size=int(even.sum()))
    return PolynomialHamiltonian(coefficients, SCALING, **PAIR, exponents=exponents[even])


def count(surrogate):
    return operations(compiled(surrogate), START)


@pytest.mark.parametrize("activation", ACTIVATIONS)
@pytest.mark.parametrize("form", [HNN, MLP, EvenHNN])
def test_what_is_counted_is_what_the_surrogate_computes(form, activation):
    surrogate = network(form, 5, activation)
    rates, _ = counted_rates(compiled(surrogate), START)
    np.testing.assert_allclose(rates, surrogate.derivative(0.0, START), rtol=1e-12)


@pytest.mark.parametrize("variant", ["hamiltonian", "as_printed"])
@pytest.mark.parametrize("modes", [1, 3])
def test_what_is_counted_is_what_the_beam_does(modes, variant):
    basis, state = reduce(beam(6), Reduction(modes=modes)), np.linspace(0.05, 0.2, 2 * modes)
    rates, _ = counted_rates(reduced_order(basis, variant, "compiled"), state)
    np.testing.assert_allclose(
        rates, reduced_order(basis, variant, "numpy").derivative(0.0, state), rtol=1e-10
    )


def test_a_neuron_takes_what_its_formula_says():
    """w·x + b: 4; z / (1 + z²): 3; times c: 1; into each of two sums: 2."""
    assert count(network(HNN, 8, "half_log")) - count(network(HNN, 7, "half_log")) == 12
    assert count(network(EvenHNN, 8, "half_log")) - count(network(EvenHNN, 7, "half_log")) == 11


def test_two_powers_more_take_two_products_and_two_sums_in_each_of_three_polynomials():
    assert count(polynomial(10)) - count(polynomial(6)) == 3 * 4


def test_a_function_of_the_library_takes_what_is_said_of_it():
    arguments, sums = 4, 4
    assert count(network(MLP, 3, "atan")) - count(network(MLP, 2, "atan")) == arguments + LIBRARY + sums


def test_a_chain_takes_as_much_for_each_of_its_elements():
    """Planar kernels sweep elements in fours."""
    costs = [
        operations(reduced_order(reduce(beam(n), Reduction(modes=1)), "hamiltonian", "compiled"), START)
        for n in (8, 16, 24)
    ]
    assert costs[2] - costs[1] == costs[1] - costs[0] > 0


def test_the_full_order_takes_more_than_the_reduced():
    basis = reduce(beam(8), Reduction(modes=1))
    full = full_order(basis.structure, "hamiltonian", "compiled")
    reduced = reduced_order(basis, "hamiltonian", "compiled")
    assert operations(full, np.zeros(16)) > operations(reduced, np.zeros(2))


def test_a_map_is_counted_too():
    inputs = Intervals(("a", "b"), np.array([-1.0, 0.0]), np.array([1.0, 2.0]))
    exponents = np.concatenate([np.zeros((1, 2), dtype=np.int64), monomials_to_degree(2, 3)])
    learned = PolynomialMap(inputs, ("y",), exponents, np.linspace(1.0, 2.0, len(exponents))[:, None])
    u = np.array([0.3, 1.2])
    outputs, taken = counted_outputs(learned.compiled(), u)
    np.testing.assert_allclose(outputs, learned(u), rtol=1e-12)
    assert taken > 2 * len(exponents)


def test_what_calls_python_cannot_be_counted():
    class Model:
        state_names, state_units, breakpoints, work_size = ("x",), ("1",), (), 0
        kernel = PythonEquations(1, lambda x: -x).kernel

    assert operations(Model(), np.ones(1)) is None
