"""Weight, learned: a rod under gravity by port-Hamiltonian surrogates with a potential, and without one."""

from dataclasses import fields

import numpy as np
import pytest

from flexsurr.beam import find_equilibrium, reduce, reduced_order
from flexsurr.config.structure import Structure
from flexsurr.config.study import InitialConditions, Reduction
from flexsurr.config.trial import trial_of
from flexsurr.surrogates import load, save
from flexsurr.training import Dataset, fit
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.inverse_dynamics import InverseDynamics, fit_port_hamiltonian
from flexsurr.training.losses import FieldErrors

ROD = Structure(
    name="rod",
    length_m=1.0,
    elements=8,
    joints=("out_of_plane",),
    mass_per_length_kg_m=0.5,
    bending_stiffness_out_of_plane_N_m2=2.0,
    damping_out_of_plane_s=0.01,
    gravity_m_s2=9.81,
)
RANGES = InitialConditions(q_min_deg=-20.0, q_max_deg=20.0, p_min_kg_m2_s=-0.1, p_max_kg_m2_s=0.1)


@pytest.fixture(scope="module")
def samples():
    basis = reduce(ROD, Reduction(modes=2, normalisation="mass", about="equilibrium"))
    return basis, configuration_samples(basis, "hamiltonian", RANGES, 600)


def held_out(surrogate, samples):
    return FieldErrors.over(surrogate, samples.validation_blocks()).nmse()


def test_a_potential_knows_weight_and_a_quadratic_form_does_not(samples):
    basis, sampled = samples
    with_it, without = (fit_port_hamiltonian(sampled, 6, potential) for potential in (True, False))
    assert held_out(with_it, sampled) < 1e-6
    assert held_out(without, sampled) > 1e-2
    rest = np.concatenate([find_equilibrium(basis), np.zeros(2)])
    size = np.abs(sampled.dx_train).max(axis=0)
    assert (np.abs(with_it.derivative(0.0, rest)) < 1e-4 * size).all()
    # what falls to rest falls by as much as the exact energy says
    exact = reduced_order(basis, "hamiltonian", "numpy")
    x = sampled.x_validation
    falls, expected = (model.energy(x) - model.energy(rest) for model in (with_it, exact))
    np.testing.assert_allclose(falls, expected, atol=1e-3 * np.abs(expected).max())


def test_it_is_found_from_rates_alone(samples):
    """As from trajectories: M, C and the potential in one linear problem, from states and rates."""
    _, sampled = samples
    scaling = fit_port_hamiltonian(sampled, 2).scaling
    problem = InverseDynamics(6, scaling, sampled, potential=True)
    for x, dx in sampled.training_blocks():
        problem.add(x, dx)
    found = problem.solve(even=False)
    assert held_out(found, sampled) < 1e-5
    largest = sampled.damping.max()
    np.testing.assert_allclose(found.damping, sampled.damping, atol=1e-2 * largest)
    np.testing.assert_array_equal(found.stiffness, 0.0)


@pytest.mark.parametrize("mass_matrix", ["factored", "entries"])
def test_a_network_of_the_mass_matrix_takes_it_too(mass_matrix, samples, tmp_path):
    _, sampled = samples
    errors = {}
    for potential in ("polynomial", None):
        trial = trial_of(
            architecture="port_hamiltonian", configurations=600, hidden=(8,), activation="atan", epochs=60,
            potential=potential, mass_matrix=mass_matrix,
        )  # fmt: skip
        result = fit(trial, sampled, tmp_path / str(potential))
        errors[potential] = held_out(result.surrogate, sampled)
    assert errors["polynomial"] < (1e-3 if mass_matrix == "factored" else 1e-6)
    assert errors[None] > 1e-2


def test_without_the_mass_matrices_entries_learn_those_of_a_polynomial(samples, tmp_path):
    """As from trajectories, with the potential that is found beside them."""
    _, sampled = samples
    known = {field.name: getattr(sampled, field.name) for field in fields(Dataset)}
    trial = trial_of(
        architecture="port_hamiltonian", hidden=(8,), activation="atan", epochs=40,
        potential="polynomial", mass_matrix="entries",
    )  # fmt: skip
    surrogate = fit(trial, Dataset(**known), tmp_path).surrogate
    assert held_out(surrogate, sampled) < 1e-5
    save(surrogate, tmp_path / "weights.npz")
    x = sampled.x_validation
    again = load(tmp_path / "weights.npz")
    np.testing.assert_array_equal(again.derivative(0.0, x), surrogate.derivative(0.0, x))


def test_an_energy_takes_no_potential_of_its_own():
    with pytest.raises(ValueError, match="potential: 'polynomial' is not allowed with polynomial"):
        trial_of(architecture="polynomial", degree=4, optimiser="least_squares", potential="polynomial")
