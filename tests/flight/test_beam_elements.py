"""Beam elements against closed forms: tip loads, cantilever and free-free frequencies, rigid-body motion."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import eigh

from flexsurr.flight.skeleton import (
    BeamElement,
    LumpedMass,
    Skeleton,
    element_axes,
    element_stiffness,
    mass_properties,
)

LENGTH, MASS_PER_LENGTH = 10.0, 3.0
SECTION = (1.0e9, 2.0e6, 5.0e6, 8.0e5)  # EA, EI flapwise, EI edgewise, GJ
# roots of cos x cosh x = −1 (clamped-free) and = 1 (free-free)
CLAMPED = np.array([1.8751040687, 4.6940911330, 7.8547574382])
FREE = np.array([4.7300407449, 7.8532046241, 10.9956078381])


def uniform_beam(count: int, direction: np.ndarray, normal: tuple[float, float, float]) -> Skeleton:
    nodes = np.linspace(0.0, LENGTH, count + 1)[:, None] * direction
    elements = tuple(BeamElement((i, i + 1), nodes[[i, i + 1]], SECTION, normal) for i in range(count))
    piece = MASS_PER_LENGTH * LENGTH / count
    masses = tuple(
        LumpedMass(i, nodes[i], piece * (0.5 if i in (0, count) else 1.0), 1e-6 * np.eye(3), "beam")
        for i in range(count + 1)
    )
    return Skeleton(nodes, elements, masses)


@given(
    st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda d: np.linalg.norm(d) > 0.3),
    st.tuples(*[st.floats(-2.0, 2.0)] * 6),
)
def test_rigid_body_motion_costs_nothing_and_stiffness_is_symmetric(direction, arms):
    nodes = np.array([[0.0, 0.0, 0.0], 2.0 * np.array(direction)])
    ends = nodes + 0.1 * np.array(arms).reshape(2, 3)
    normal = (0.0, 0.0, 1.0) if abs(direction[2]) < 0.8 * np.linalg.norm(direction) else (0.0, 1.0, 0.0)
    element = BeamElement((0, 1), ends, SECTION, normal)
    k = element_stiffness(element, nodes)
    motions = Skeleton(nodes, (element,), ()).rigid_body_motions(np.array([1.0, -2.0, 0.5]))
    assert np.abs(k @ motions).max() < 1e-9 * np.abs(k).max()
    assert np.abs(k - k.T).max() < 1e-12 * np.abs(k).max()


def test_a_tip_load_bends_a_cantilever_as_in_the_books():
    beam = uniform_beam(4, np.array([1.0, 0.0, 0.0]), (0.0, 0.0, 1.0))
    k = beam.stiffness_matrix()[6:, 6:]
    load = np.zeros(24)
    load[-6:] = [10.0, 20.0, 30.0, 40.0, 0.0, 0.0]
    tip = np.linalg.solve(k, load)[-6:]
    ea, flapwise, edgewise, gj = SECTION
    assert tip[0] == pytest.approx(10.0 * LENGTH / ea)
    assert tip[1] == pytest.approx(20.0 * LENGTH**3 / (3.0 * edgewise))
    assert tip[2] == pytest.approx(30.0 * LENGTH**3 / (3.0 * flapwise))
    assert tip[3] == pytest.approx(40.0 * LENGTH / gj)
    assert tip[4] == pytest.approx(-30.0 * LENGTH**2 / (2.0 * flapwise))
    assert tip[5] == pytest.approx(20.0 * LENGTH**2 / (2.0 * edgewise))


@pytest.mark.parametrize(("clamped", "roots"), [(True, CLAMPED), (False, FREE)])
def test_bending_frequencies_of_a_uniform_beam_converge_with_the_square_of_element_length(clamped, roots):
    direction = np.array([2.0, -1.0, 2.0]) / 3.0
    exact = (roots / LENGTH) ** 2 * np.sqrt(SECTION[1] / MASS_PER_LENGTH)
    errors = []
    for count in (20, 40):
        beam = uniform_beam(count, direction, (1.0, 0.0, -1.0))
        k, m = beam.stiffness_matrix(), beam.mass_matrix()
        keep = np.arange(6 if clamped else 0, len(k))
        # only the plane of flapwise bending moves
        normal = element_axes(beam.elements[0])
        plane = np.kron(np.eye(count + 1), np.array([[*normal[2], 0, 0, 0], [0, 0, 0, *normal[1]]]))
        plane = plane[2 if clamped else 0 :, keep]
        k, m = plane @ k[np.ix_(keep, keep)] @ plane.T, plane @ m[np.ix_(keep, keep)] @ plane.T
        squares = 1.0 / eigh(m, k + m, eigvals_only=True)[::-1] - 1.0
        found = np.sqrt(squares[0 if clamped else 2 :][:3])
        errors.append(np.abs(found / exact - 1.0))
    assert errors[1].max() < 6e-3
    assert errors[1].max() < 0.3 * errors[0].max()


def test_a_node_with_arms_moves_as_if_the_end_were_its_own():
    ends = np.array([[0.0, 0.0, 0.0], [3.0, 1.0, 0.0]])
    direct = element_stiffness(BeamElement((0, 1), ends, SECTION, (0.0, 0.0, 1.0)), ends)
    nodes = ends + np.array([[0.0, 0.0, 2.0], [0.5, 0.0, 0.0]])
    carried = element_stiffness(BeamElement((0, 1), ends, SECTION, (0.0, 0.0, 1.0)), nodes)
    motion = np.array([0.1, -0.2, 0.3, 0.01, -0.02, 0.03, 0.2, 0.1, -0.1, 0.02, 0.05, -0.04])
    moved = motion.copy()
    for end in range(2):
        s = slice(6 * end, 6 * end + 3)
        moved[s] += np.cross(motion[6 * end + 3 : 6 * end + 6], ends[end] - nodes[end])
    assert motion @ carried @ motion == pytest.approx(moved @ direct @ moved, rel=1e-12)


def test_a_normal_along_the_element_is_refused():
    element = BeamElement((0, 1), np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), SECTION, (0.0, 0.0, 1.0))
    with pytest.raises(ValueError, match="along the element"):
        element_axes(element)


def test_mass_properties_of_a_uniform_rod():
    beam = uniform_beam(200, np.array([0.0, 1.0, 0.0]), (0.0, 0.0, 1.0))
    found = mass_properties(beam)
    mass = MASS_PER_LENGTH * LENGTH
    assert found.mass == pytest.approx(mass)
    assert found.centre_of_gravity == pytest.approx([0.0, 0.5 * LENGTH, 0.0], abs=1e-12)
    across = mass * LENGTH**2 / 12.0
    assert np.diag(found.inertia) == pytest.approx([across, 2e-4, across], rel=1e-3, abs=1e-3)
