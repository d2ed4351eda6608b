import numpy as np
import pytest
from hypothesis import given, settings
from structures import ALL_JOINTS, BEND, CANTILEVER, FORMS, SEEDS, any_structures, change, coordinates

from flexsurr.beam import element_frames, node_positions, tip_position, tip_twist
from flexsurr.beam.chain import chain
from flexsurr.beam.described import jacobians, points
from flexsurr.beam.described import velocities as described_velocities
from flexsurr.beam.kinematics import configuration, generalised_forces, velocities


@given(any_structures(), SEEDS)
def test_frames_are_rotations_and_elements_keep_their_length(structure, seed):
    q = coordinates(structure, seed)
    frames, nodes = element_frames(structure, q), node_positions(structure, q)
    identities = np.broadcast_to(np.eye(3), frames.shape)
    np.testing.assert_allclose(frames @ np.swapaxes(frames, -1, -2), identities, atol=1e-14)
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-14)
    stretch = q[-structure.elements :] if "axial" in structure.joints else 0.0
    lengths = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    expected = np.abs(np.linalg.norm(chain(structure).spans, axis=1) + stretch)
    np.testing.assert_allclose(lengths, expected, atol=1e-14)


@given(any_structures(), SEEDS)
def test_both_kinematics_agree(structure, seed):
    q = coordinates(structure, seed)
    at = configuration(chain(structure), q)
    described = points(structure, q)
    np.testing.assert_allclose(at.masses, described.masses, atol=1e-14)
    np.testing.assert_allclose(at.centres, described.centres, atol=1e-14)
    np.testing.assert_allclose(at.nodes[-1], described.tip, atol=1e-14)
    np.testing.assert_allclose(at.frames, described.frames, atol=1e-14)


@given(any_structures(), SEEDS)
def test_velocities_are_the_time_derivative_of_positions(structure, seed):
    q, rates = coordinates(structure, seed), coordinates(structure, seed + 1)
    step = 1e-30
    expected = configuration(chain(structure), q + 1j * step * rates).masses.imag / step
    at = configuration(chain(structure), q)
    swept = velocities(chain(structure), at, rates[None])
    np.testing.assert_allclose(swept.masses[0], expected, atol=1e-13)
    of_masses, spins = described_velocities(structure, q, rates)
    np.testing.assert_allclose(of_masses, expected, atol=1e-13)
    np.testing.assert_allclose(jacobians(structure, q).masses @ rates, expected, atol=1e-13)
    turning = (np.swapaxes(at.frames, 1, 2) @ swept.turning[0][:, :, None])[:, :, 0]
    np.testing.assert_allclose(turning, spins, atol=1e-13)


@given(any_structures(), SEEDS)
def test_frames_turn_with_their_angular_velocity(structure, seed):
    q, rates = coordinates(structure, seed), coordinates(structure, seed + 1)
    moved = configuration(chain(structure), q + 1e-30j * rates).frames.imag / 1e-30
    at = configuration(chain(structure), q)
    turning = velocities(chain(structure), at, rates[None]).turning[0]
    expected = np.cross(turning[:, :, None], at.frames, axis=1)
    np.testing.assert_allclose(moved, expected, atol=1e-13)


@given(any_structures(), SEEDS)
def test_generalised_forces_do_the_work_of_the_forces(structure, seed):
    q = coordinates(structure, seed)
    random = np.random.default_rng(seed)
    on_masses, on_centres = random.normal(size=(2, structure.elements, 3))
    on_tip = random.normal(size=3)
    jacobian = jacobians(structure, q)
    expected = np.einsum("ikn,ik->n", jacobian.masses, on_masses)
    expected = expected + np.einsum("ikn,ik->n", jacobian.centres, on_centres)
    beam = chain(structure)
    found = generalised_forces(beam, configuration(beam, q), on_masses, on_centres, on_tip)
    np.testing.assert_allclose(found, expected + jacobian.tip.T @ on_tip, atol=1e-12)


@settings(max_examples=10)
@given(any_structures(), SEEDS)
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


def test_an_unloaded_axis_follows_its_table():
    """Directions and places of a swept, bent and twisted axis; and no twist at rest."""
    structure = change(STRAIGHT, **FORMS[-1], elements=40)
    q = np.zeros(structure.coordinates)
    frames, nodes = element_frames(structure, q), node_positions(structure, q)
    psi, theta, phi = (
        np.array([*values]) for values in (BEND.axis_psi_deg, BEND.axis_theta_deg, BEND.axis_phi_deg)
    )
    at = (
        np.interp(0.75, BEND.stations_m, psi),
        np.interp(0.75, BEND.stations_m, theta),
        np.interp(0.75, BEND.stations_m, phi),
    )
    clamp = change(STRAIGHT, elements=1, clamp_psi_deg=at[0], clamp_theta_deg=at[1], clamp_phi_deg=at[2])
    np.testing.assert_allclose(frames[25], element_frames(clamp, np.zeros(4))[0], atol=1e-14)
    s = np.linspace(0.0, 1.2, 20001)
    angles = np.deg2rad([np.interp(s, BEND.stations_m, values) for values in (psi, theta)])
    x = np.array(
        [np.cos(angles[0]) * np.cos(angles[1]), np.sin(angles[0]) * np.cos(angles[1]), np.sin(angles[1])]
    )
    line = np.array([np.trapezoid(part, s) for part in x])
    beside = (
        -0.02
        * element_frames(
            change(clamp, clamp_psi_deg=40.0, clamp_theta_deg=20.0, clamp_phi_deg=30.0), np.zeros(4)
        )[0][:, 1]
    )
    np.testing.assert_allclose(nodes[-1], line + beside, atol=1e-7)
    assert tip_twist(structure, q) == pytest.approx(0.0, abs=1e-14)


def test_a_vector_is_the_sequence_where_one_kind_of_joint_turns():
    for joint in range(3):
        q = np.zeros(12)
        q[3 * joint : 3 * joint + 3] = [0.3, -0.5, 0.2]
        sequence, vector = (
            tip_position(change(ALL_JOINTS, joint_rotation=kind), q) for kind in ("sequence", "vector")
        )
        np.testing.assert_allclose(sequence, vector, atol=1e-15)
