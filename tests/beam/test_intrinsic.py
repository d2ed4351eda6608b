"""The chain in intrinsic variables: exact to second order, lossless, and, finer, the chain itself."""

import numpy as np
import pytest
from structures import ALL_JOINTS, CANTILEVER, change

from flexsurr.beam import full_order, natural_modes
from flexsurr.beam.chain import chain
from flexsurr.beam.described import points, velocities
from flexsurr.beam.intrinsic import (
    IntrinsicModel,
    joint_velocities,
    strain_products,
    strains_of,
    stretching_modes,
)
from flexsurr.config.structure import Structure
from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate

WING = Structure(
    name="wing",
    length_m=16.0,
    elements=4,
    joints=("in_plane", "out_of_plane", "torsion", "axial"),
    mass_per_length_kg_m=0.75,
    bending_stiffness_in_plane_N_m2=4.0e6,
    bending_stiffness_out_of_plane_N_m2=2.0e4,
    torsional_stiffness_N_m2=1.0e4,
    axial_stiffness_N=1.0e6,
    torsional_inertia_per_length_kg_m=0.1,
    inertia_about_y_per_length_kg_m=0.04,
    chord_m=1.0,
    centre_of_gravity_offset_m=0.1,
)
TIGHT = Integrator(method="scipy_dop853", rtol=1e-9, atol=1e-11)


def all_modes(structure: Structure) -> IntrinsicModel:
    return IntrinsicModel(structure, range(structure.coordinates))


def error_of_rates(size: float, with_products: bool) -> float:
    """The largest error of the rates of strain at angles of this size, whose true ones are given."""
    rigid = change(WING, joints=("in_plane", "out_of_plane", "torsion"))
    beam, rng = chain(rigid), np.random.default_rng(1)
    q, rates = size * rng.normal(size=beam.coordinates), rng.normal(size=beam.coordinates)
    seen, spins = velocities(rigid, q, rates)
    frames = points(rigid, q).frames
    v = np.concatenate([np.r_[f.T @ s, w] for f, s, w in zip(frames, seen, spins, strict=True)])[:, None]
    after, before = joint_velocities(beam)
    found = ((after - before) @ v)[:, :, 0]
    if with_products:
        strains = strains_of(rigid, q[:, None])
        found = found + strain_products(0.5 * (after + before), strains, v)[:, :, 0, 0]
    return float(np.abs(found - strains_of(rigid, rates[:, None])[:, :, 0]).max())


@pytest.mark.parametrize(("with_products", "order"), [(False, 1.0), (True, 2.0)])
def test_rates_of_strain_are_those_of_the_chain_but_for_products_of_two_turns(with_products, order):
    errors = [error_of_rates(size, with_products) for size in (0.02, 0.01)]
    assert np.log2(errors[0] / errors[1]) > order - 0.1
    assert with_products or np.log2(errors[0] / errors[1]) < 1.2


def test_energy_stays_at_any_state():
    model = all_modes(WING)
    for seed in range(5):
        x = 10.0 * np.random.default_rng(seed).normal(size=2 * WING.coordinates)
        terms = x * model.derivative(0.0, x)
        assert abs(terms.sum()) < 1e-13 * np.abs(terms).sum()
        assert np.abs(model.derivative(0.0, 2.0 * x) - 2.0 * model.derivative(0.0, x)).max() > 1.0


def test_it_holds_the_energy_of_the_springs_and_the_shape():
    model, q = all_modes(WING), 0.1 * np.random.default_rng(0).normal(size=WING.coordinates)
    x = model.at_rest(q)
    assert model.joints(x) == pytest.approx(q, rel=1e-9)
    assert model.energy(x) == pytest.approx(full_order(WING, "hamiltonian", "numpy").energy(np.r_[q, 0 * q]))


def test_small_motion_is_that_of_the_chain():
    model = all_modes(WING)
    x = 1e-9 * np.random.default_rng(0).normal(size=2 * WING.coordinates)
    omega = natural_modes(WING, np.zeros(WING.coordinates))[0]
    q, s = np.split(x, 2)
    linear = np.concatenate([-omega * s, omega * q])
    assert np.abs(model.derivative(0.0, x) - linear).max() < 1e-6 * np.abs(linear).max()


def distance(structure: Structure, amplitudes: dict[int, float], t) -> float:
    """The largest distance of the tip from the full-order chain's, over the peak; let go in some modes."""
    modes = natural_modes(structure, np.zeros(structure.coordinates))[1]
    q = sum(size * modes[:, mode] for mode, size in amplitudes.items())
    chain_model, model = full_order(structure, "hamiltonian", "compiled"), all_modes(structure)
    exact = chain_model.tip(simulate(chain_model, t, np.r_[q, 0.0 * q], TIGHT).x)
    found = model.tip(simulate(model, t, model.at_rest(q), TIGHT).x)
    at_rest = np.array([structure.length_m, 0.0, 0.0])
    return float(np.linalg.norm(found - exact, axis=1).max() / np.linalg.norm(exact - at_rest, axis=1).max())


def test_in_a_plane_it_comes_to_the_full_order_chain_as_elements_get_shorter():
    planar = change(CANTILEVER, joints=("out_of_plane", "axial"), axial_stiffness_N=2.0e4)
    t = np.linspace(0.0, 0.1, 21)
    coarse, fine = (distance(change(planar, elements=n), {0: 0.06}, t) for n in (4, 8))
    assert fine < 0.6 * coarse
    assert fine < 6e-4  # the tip rises by a quarter of the span


def test_in_space_it_strays_with_the_square_of_the_motion():
    """What is left out of the rates is of third order, so in proportion to the motion of second."""
    wing = change(WING, elements=2)
    t = np.linspace(0.0, 0.5, 11)
    far, near = (distance(wing, {0: size, 2: 0.1 * size, 3: 0.1 * size}, t) for size in (1.0, 0.5))
    assert 3.0 < far / near < 5.0


def test_modes_of_a_straight_axis_bend_or_stretch():
    wing = change(WING, centre_of_gravity_offset_m=0.0)
    bends, stretches = stretching_modes(wing)
    modes = natural_modes(wing, np.zeros(wing.coordinates))[1]
    assert len(stretches) == wing.elements
    assert np.abs(modes[-wing.elements :, bends]).max() < 1e-8 * np.abs(modes).max()


@pytest.mark.parametrize("structure", [ALL_JOINTS, change(WING, gravity_m_s2=9.81)])
def test_other_chains_are_refused(structure):
    with pytest.raises(ValueError, match="it has no intrinsic form here"):
        all_modes(structure)
