import numpy as np
import pytest
from hypothesis import given, settings
from structures import ALL_JOINTS, CANTILEVER, SEEDS, change, coordinates, structures

from flexsurr.beam import element_frames, node_positions, tip_position, tip_twist
from flexsurr.beam.chain import chain
from flexsurr.beam.described import jacobians, points
from flexsurr.beam.described import velocities as described_velocities
from flexsurr.beam.kinematics import configuration, generalised_forces, velocities


@given(structures(), SEEDS)
def test_frames_are_rotations_and_elements_keep_their_length(structure, seed):
    q = coordinates(structure, seed)
    frames, nodes = element_frames(structure, q), node_positions(structure, q)
    identities = np.broadcast_to(np.eye(3), frames.shape)
    np.testing.assert_allclose(frames @ np.swapaxes(frames, -1, -2), identities, atol=1e-14)
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-14)
    stretch = q[-structure.elements :] if "axial" in structure.joints else 0.0
    lengths = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    expected = np.abs(structure.length_m / structure.elements + stretch)
    np.testing.assert_allclose(lengths, expected, atol=1e-14)


@given(structures(), SEEDS)
def test_both_kinematics_agree(structure, seed):
    q = coordinates(structure, seed)
    at = configuration(chain(structure), q)
    masses, centres, tip = points(structure, q)
    np.testing.assert_allclose(at.masses, masses, atol=1e-14)
    np.testing.assert_allclose(at.centres, centres, atol=1e-14)
    np.testing.assert_allclose(at.nodes[-1], tip, atol=1e-14)


@given(structures(), SEEDS)
def test_velocities_are_the_time_derivative_of_positions(structure, seed):
    q, rates = coordinates(structure, seed), coordinates(structure, seed + 1)
    step = 1e-30
    expected = configuration(chain(structure), q + 1j * step * rates).masses.imag / step
    swept = velocities(chain(structure), configuration(chain(structure), q), rates[None]).masses[0]
    np.testing.assert_allclose(swept, expected, atol=1e-13)
    np.testing.assert_allclose(described_velocities(structure, q, rates), expected, atol=1e-13)
    of_masses, _, _ = jacobians(structure, q)
    np.testing.assert_allclose(of_masses @ rates, expected, atol=1e-13)


@given(structures(), SEEDS)
def test_generalised_forces_do_the_work_of_the_forces(structure, seed):
    q = coordinates(structure, seed)
    random = np.random.default_rng(seed)
    on_masses, on_centres = random.normal(size=(2, structure.elements, 3))
    on_tip = random.normal(size=3)
    of_masses, of_centres, of_tip = jacobians(structure, q)
    expected = np.einsum("ikn,ik->n", of_masses, on_masses) + np.einsum("ikn,ik->n", of_centres, on_centres)
    beam = chain(structure)
    found = generalised_forces(beam, configuration(beam, q), on_masses, on_centres, on_tip)
    np.testing.assert_allclose(found, expected + of_tip.T @ on_tip, atol=1e-12)


@settings(max_examples=10)
@given(structures(), SEEDS)
def test_leading_axes_are_states(structure, seed):
    q = coordinates(structure, seed) * np.linspace(0.0, 1.0, 6).reshape(2, 3, 1)
    tips = tip_position(structure, q)
    assert tips.shape == (2, 3, 3)
    np.testing.assert_allclose(tips[1, 2], tip_position(structure, q[1, 2]), atol=1e-14)
    assert node_positions(structure, q).shape == (2, 3, structure.elements + 1, 3)


STRAIGHT = change(ALL_JOINTS, clamp_psi_deg=0.0, clamp_theta_deg=0.0, clamp_phi_deg=0.0)


@pytest.mark.parametrize(("block", "axis", "sign"), [(0, 1, 1.0), (1, 2, 1.0), (3, 0, 1.0)])
def test_positive_joints_turn_to_the_left_lift_and_stretch(block, axis, sign):
    q = np.zeros(12)
    q[3 * block] = 0.1
    moved = tip_position(STRAIGHT, q) - tip_position(STRAIGHT, np.zeros(12))
    assert sign * moved[axis] > 0.09


def test_positive_torsion_lifts_the_left_side():
    q = np.zeros(12)
    q[6] = 0.1
    assert element_frames(STRAIGHT, q)[0, 2, 1] == pytest.approx(np.sin(0.1))


def test_the_clamp_turns_with_the_signs_of_the_joints():
    turned = change(STRAIGHT, clamp_psi_deg=20.0, clamp_theta_deg=30.0, clamp_phi_deg=40.0)
    q = np.zeros(12)
    q[[0, 3, 6]] = np.deg2rad([20.0, 30.0, 40.0])
    np.testing.assert_allclose(tip_position(turned, np.zeros(12)), tip_position(STRAIGHT, q), atol=1e-15)


def test_a_vector_of_the_wrong_length_is_refused():
    with pytest.raises(ValueError, match=r"q has shape \(9,\); cantilever has 10 coordinates"):
        tip_position(CANTILEVER, np.zeros(9))


def test_twist_is_the_angle_of_torsion_whatever_the_clamp_and_the_bending_before():
    """Torsion at the last element alone adds its angle to that of the chain without it."""
    structure = change(ALL_JOINTS, elements=4)
    q = np.zeros(16)
    torsion = slice(8, 12)
    q[torsion] = [0.1, -0.3, 0.6, 0.2]
    assert tip_twist(structure, q) == pytest.approx(0.6, abs=1e-14)
    q = coordinates(structure, 1)
    before, after = (tip_twist(structure, q + angle * np.eye(16)[11]) for angle in (0.0, 0.25))
    assert after - before == pytest.approx(0.25, abs=1e-13)
