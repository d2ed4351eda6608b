import numpy as np
from hypothesis import given
from structures import ALL_JOINTS, CANTILEVER, SEEDS, any_structures, basis_of, change, state

from flexsurr.beam import full_order, mass_matrix, reduced_order
from flexsurr.config.structure import JOINTS

STEP = 1e-30


def power(model, x):
    """(dH/dt, the sum of the magnitudes of its terms) at x, by a complex step along the right-hand side."""
    gradient = model.energy(x + 1j * STEP * np.eye(len(x))).imag / STEP
    terms = gradient * model.derivative(0.0, x)
    return terms.sum(), np.abs(terms).sum()


UNDAMPED = {f"damping_{joint}_s": 0.0 for joint in JOINTS}


@given(any_structures(**UNDAMPED), SEEDS)
def test_the_full_order_model_conserves_energy(structure, seed):
    model = full_order(structure, "hamiltonian", "compiled")
    rate, scale = power(model, state(structure, seed))
    assert abs(rate) <= 1e-12 * scale


@given(any_structures(**UNDAMPED), SEEDS)
def test_the_reduced_order_model_conserves_energy(structure, seed):
    basis = basis_of(structure)
    model = reduced_order(basis, "hamiltonian", "numpy")
    rate, scale = power(model, state(basis, seed))
    assert abs(rate) <= 1e-12 * scale


@given(any_structures(damping_out_of_plane_s=0.02, damping_torsion_s=0.02), SEEDS)
def test_dampers_take_energy_out_at_the_rate_of_their_dissipation(structure, seed):
    basis = basis_of(structure)
    model = reduced_order(basis, "hamiltonian", "compiled")
    x = state(basis, seed)
    rates = model.derivative(0.0, x)[: len(x) // 2]
    rate, scale = power(model, x)
    assert abs(rate + rates @ basis.damping @ rates) <= 1e-12 * scale


def test_the_printed_variant_does_not_conserve_energy():
    model = reduced_order(basis_of(CANTILEVER, 1, "unit"), "as_printed", "numpy")
    rate, scale = power(model, np.array([0.3, 1.5]))
    assert abs(rate) > 1e-3 * scale


def test_energy_counts_motion_springs_and_height():
    structure = change(ALL_JOINTS, clamp_psi_deg=0.0, clamp_theta_deg=0.0, clamp_phi_deg=0.0)
    model = full_order(structure, "hamiltonian", "numpy")
    x = np.zeros(24)
    assert model.energy(x) == 0.0
    x[3] = np.pi / 2  # straight up
    mass, span, spring = 0.48, 1.2, 6 * 50.0 * 1.2 / (0.4 * (3 * 1.2 - 0.4))
    rates = np.linspace(-1.0, 1.0, 12)
    x[12:] = mass_matrix(structure, x[:12]) @ rates
    kinetic = 0.5 * rates @ x[12:]
    expected = kinetic + 0.5 * spring * (np.pi / 2) ** 2 + mass * 9.81 * span / 2
    np.testing.assert_allclose(model.energy(np.tile(x, (2, 1))), expected, rtol=1e-13)
