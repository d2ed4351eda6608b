"""Configurations without a simulation: linear motion from a dataset's initial states."""

import numpy as np
import pytest
from structures import ALL_JOINTS, CANTILEVER, basis_of, change

from flexsurr.beam import mass_matrix, natural_modes, reduced_order
from flexsurr.beam.initial_conditions import initial_states
from flexsurr.beam.linear_motion import sample_configurations
from flexsurr.config.study import InitialConditions, Integrator
from flexsurr.simulation import simulate

DAMPED = change(ALL_JOINTS, gravity_m_s2=0.0, damping_torsion_s=0.5, damping_out_of_plane_s=0.01)
TIGHT = Integrator(method="scipy_radau", rtol=1e-9, atol=1e-14)
WIDE, JOINT = InitialConditions(), InitialConditions(kind="joint")


@pytest.mark.parametrize("settings", [WIDE, JOINT])
def test_a_part_is_part_of_one_sequence(settings):
    basis = basis_of(DAMPED)
    together = sample_configurations(basis, settings, 0, 40)
    alone = sample_configurations(basis, settings, 25, 15)
    for found, expected in zip(alone, together, strict=True):
        np.testing.assert_allclose(found, expected[25:], rtol=1e-13)


def test_they_do_not_depend_on_the_normalisation():
    unit, mass = basis_of(DAMPED, 3, "unit"), basis_of(DAMPED, 3, "mass")
    found = zip(
        sample_configurations(unit, WIDE, 0, 30), sample_configurations(mass, WIDE, 0, 30), strict=True
    )
    for of_unit, of_mass in found:
        np.testing.assert_allclose(of_unit @ unit.modes.T, of_mass @ mass.modes.T, atol=1e-9)


@pytest.mark.parametrize("gravity", [0.0, 1e-3])
def test_small_motions_are_those_of_the_reduced_model(gravity):
    """The sequence begins with the middle of all ranges: half a period from there."""
    basis = basis_of(change(DAMPED, gravity_m_s2=gravity))
    small = InitialConditions(q_min_deg=0.0, q_max_deg=2e-3, p_max_kg_m2_s=1e-4)
    (eta,), (rates,) = sample_configurations(basis, small, 0, 1)
    model = reduced_order(basis, "hamiltonian", "numpy")
    half_period_s = np.pi / natural_modes(basis.structure, basis.equilibrium)[0][0]
    start = initial_states(basis, small, np.full((1, 6), 0.5))[0]
    end = simulate(model, np.array([0.0, half_period_s]), start, TIGHT).x[-1]
    np.testing.assert_allclose(eta, end[:3], atol=1e-3 * np.max(np.abs(start[:3])))
    np.testing.assert_allclose(model.mass_matrix(eta) @ rates, end[3:], atol=1e-3 * np.max(np.abs(end[3:])))


def linear_energy(basis, eta, rates):
    mass = basis.modes.T @ mass_matrix(basis.structure, np.zeros(basis.structure.coordinates)) @ basis.modes
    kinetic = np.einsum("si,ij,sj->s", rates, mass, rates)
    return 0.5 * kinetic + 0.5 * np.einsum("si,ij,sj->s", eta, basis.stiffness, eta)


@pytest.mark.parametrize("structure", [CANTILEVER, DAMPED])
def test_no_energy_is_more_than_that_of_the_initial_states(structure):
    basis = basis_of(structure)
    eta, rates = sample_configurations(basis, WIDE, 0, 300)
    corners = np.array(np.meshgrid(*[[0.0, 1.0]] * 6)).reshape(6, -1).T
    start = initial_states(basis, WIDE, corners)
    mass = basis.modes.T @ mass_matrix(structure, np.zeros(structure.coordinates)) @ basis.modes
    most = linear_energy(basis, start[:, :3], np.linalg.solve(mass, start[:, 3:].T).T).max()
    assert linear_energy(basis, eta, rates).max() <= most


def test_they_reach_as_far_as_trajectories_which_is_beyond_the_initial_states():
    """Dampers that couple modes drive them further than they began."""
    wing = change(
        DAMPED,
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
    basis = basis_of(wing)
    model = reduced_order(basis, "hamiltonian", "numpy")
    corners = initial_states(
        basis, WIDE, np.array([[0, 0, 0, 1, 1, 1], [0, 1, 0, 1, 0, 1], [1, 0, 1, 0, 1, 0]])
    )
    t, rough = np.linspace(0.0, 1.0, 51), Integrator(method="scipy_radau")
    visited = np.concatenate([simulate(model, t, x0, rough).x[:, :3] for x0 in corners])
    eta, _ = sample_configurations(basis, WIDE, 0, 2000)
    reach, limits = np.abs(eta).max(axis=0), np.abs(corners[:, :3]).max(axis=0)
    assert (np.abs(visited).max(axis=0) > 1.3 * limits).any()
    assert (np.abs(visited).max(axis=0) < 1.25 * reach).all()
    assert (reach < 2.0 * limits).all()
