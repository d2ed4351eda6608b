"""Learning without a simulation: sampled configurations, and the mass matrices there."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_inverse_dynamics import R, truth_of

from flexsurr.beam import draw_initial_conditions, reduce, reduced_order
from flexsurr.config.structure import Structure
from flexsurr.config.study import InitialConditions, Integrator, Reduction
from flexsurr.config.trial import trial_of
from flexsurr.simulation import simulate
from flexsurr.training import fit, nmse
from flexsurr.training.configuration_samples import ConfigurationSamples, configuration_samples
from flexsurr.training.inverse_dynamics import fit_port_hamiltonian

BEAM = Structure(
    name="beam",
    length_m=16.0,
    elements=6,
    joints=("out_of_plane", "torsion"),
    mass_per_length_kg_m=0.75,
    bending_stiffness_out_of_plane_N_m2=2e4,
    torsional_stiffness_N_m2=1e3,
    torsional_inertia_per_length_kg_m=0.1,
    chord_m=1.0,
    centre_of_gravity_offset_m=0.267,
    damping_out_of_plane_s=0.1,
    damping_torsion_s=10.0,
)
ANY = InitialConditions()


def basis_of(structure=BEAM, modes=2, **changed):
    structure = structure.model_copy(update=changed)
    return reduce(structure, Reduction(modes=modes, normalisation="mass"))


def known(truth, samples=300, seed=0):
    """Random states of a system whose mass matrix is a polynomial, with everything known about it."""
    generator = np.random.default_rng(seed)
    x = generator.uniform(-1.0, 1.0, (samples, 2 * R)) * truth.scaling.states(2 * R)
    dx, cut = truth.derivative(0.0, x), samples // 4
    return ConfigurationSamples(
        x_train=x[cut:],
        dx_train=dx[cut:],
        x_validation=x[:cut],
        dx_validation=dx[:cut],
        trajectory_train=np.arange(cut, samples),
        trajectory_validation=np.arange(cut),
        state_names=truth.state_names,
        state_units=truth.state_units,
        sha256="none",
        mass=truth.mass_matrix(x[cut:, :R]),
        forces=-x[cut:, :R] @ truth.stiffness,
        stiffness=truth.stiffness,
        damping=truth.damping,
        mirrors=np.empty((0, R)),
    )


@given(seed=st.integers(0, 2**32 - 1), even=st.booleans(), damped=st.booleans())
@settings(max_examples=10)
def test_a_polynomial_mass_matrix_is_found_to_rounding(seed, even, damped):
    truth = truth_of(seed, even=even, damped=damped)
    samples = known(truth)
    found = fit_port_hamiltonian(samples, 4)
    assert np.array_equal(found.exponents, truth.exponents)
    for name in ("stiffness", "damping"):
        expected = getattr(truth, name)
        np.testing.assert_allclose(getattr(found, name), expected, atol=1e-12 * (1 + np.abs(expected).max()))
    assert nmse(found.derivative(0.0, samples.x_validation), samples.dx_validation) < 1e-20


@pytest.mark.parametrize("variant", ["hamiltonian", "as_printed"])
def test_samples_are_states_of_the_reduced_model_with_its_derivatives(variant):
    basis = basis_of()
    samples = configuration_samples(basis, variant, ANY, 50)
    model = reduced_order(basis, variant, "described")
    expected = np.array([model.derivative(0.0, x) for x in samples.x_train])
    np.testing.assert_allclose(samples.dx_train, expected, rtol=1e-9, atol=1e-8)
    momenta = np.einsum("sij,sj->si", samples.mass, samples.dx_train[:, :2])
    np.testing.assert_allclose(momenta, samples.x_train[:, 2:], rtol=1e-9, atol=1e-9)
    assert (len(samples.x_train), len(samples.x_validation)) == (50, 10)


def test_without_gravity_the_stiffness_is_that_of_the_modes():
    basis = basis_of()
    found = configuration_samples(basis, "hamiltonian", ANY, 50).stiffness
    np.testing.assert_allclose(found, basis.stiffness, atol=1e-10 * np.max(basis.stiffness))


def test_gravity_changes_the_stiffness_as_it_does_the_tangent():
    """A beam that hangs is stiffer."""
    hanging = basis_of(gravity_m_s2=9.81, clamp_theta_deg=-90.0)
    found = configuration_samples(hanging, "hamiltonian", ANY, 50).stiffness
    assert (np.diag(found) > 1.02 * np.diag(hanging.stiffness)).any()


def test_fitted_without_a_simulation_it_holds_on_trajectories():
    basis = basis_of()
    model = reduced_order(basis, "hamiltonian", "numpy")
    t, method = np.linspace(0.0, 1.0, 41), Integrator(method="scipy_radau", rtol=1e-6, atol=1e-9)
    starts = draw_initial_conditions(basis, ANY, 5, 0, 6)
    x = np.concatenate([simulate(model, t, x0, method).x for x0 in starts])
    dx = np.array([model.derivative(0.0, state) for state in x])
    samples = configuration_samples(basis, "hamiltonian", ANY, 500)
    errors = [nmse(fit_port_hamiltonian(samples, degree).derivative(0.0, x), dx) for degree in (2, 4, 6, 8)]
    assert errors[-1] < 1e-7
    assert (np.diff(errors) < 0.0).all()


@pytest.mark.parametrize(
    "values",
    [
        {"architecture": "port_hamiltonian", "degree": 6, "optimiser": "least_squares"},
        {"architecture": "port_hamiltonian", "hidden": (6,), "activation": "atan", "epochs": 80},
        {"architecture": "mlp", "hidden": (8,), "activation": "tanh", "epochs": 40},
    ],
)
def test_every_kind_of_trial_takes_them(tmp_path, values):
    samples = configuration_samples(basis_of(), "hamiltonian", ANY, 300)
    result = fit(trial_of(**values), samples, tmp_path)
    assert result.status == "finished"
    assert result.validation_nmse < 0.5


def test_an_undamped_beam_needs_no_other_weights():
    basis = basis_of(damping_out_of_plane_s=0.0, damping_torsion_s=0.0)
    samples = configuration_samples(basis, "hamiltonian", ANY, 300)
    found = fit_port_hamiltonian(samples, 8)
    assert nmse(found.derivative(0.0, samples.x_validation), samples.dx_validation) < 1e-4
    assert not np.any(found.damping)


def test_masses_that_are_none_are_a_failure_with_a_reason(tmp_path):
    samples = known(truth_of(3))
    turned = replace(samples, mass=-samples.mass)
    trial = trial_of(architecture="port_hamiltonian", degree=4, optimiser="least_squares")
    result = fit(trial, turned, tmp_path)
    assert result.status == "failed"
    assert "not positive definite at q = (" in result.reason
