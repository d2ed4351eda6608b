"""The airliner's lattice, and what it refuses."""

import numpy as np
import pytest
from wings import AIRLINER, CENTRE_OF_GRAVITY, FEW

from flexsurr.aerodynamics.airframe import Airframe, ModalMotion, apparent_mass_difference
from flexsurr.aerodynamics.features import (
    COEFFICIENT_UNITS,
    COEFFICIENTS,
    FEATURE_UNITS,
    FEATURES,
    ReferenceDimensions,
)
from flexsurr.aerodynamics.lattice import (
    AILERON_LEFT,
    AILERON_RIGHT,
    ELEVATOR_LEFT,
    INCIDENCE,
    RUDDER,
    PanelCounts,
    airliner_lattice,
)
from flexsurr.aerodynamics.mach_grid import fixed_machs, mach_grid

LATTICE = airliner_lattice(AIRLINER)


def test_there_are_25_features_and_12_coefficients_with_units():
    assert len(FEATURES) == len(FEATURE_UNITS) == 25
    assert len(COEFFICIENTS) == len(COEFFICIENT_UNITS) == 12


def test_size_and_place():
    assert 340 <= len(LATTICE) <= 480
    right_tip, left_tip = LATTICE.corners[..., 1].max(), LATTICE.corners[..., 1].min()
    assert right_tip - left_tip == pytest.approx(AIRLINER.published.wing_span_m, abs=0.01)
    area = 0.5 * np.linalg.norm(
        np.cross(
            LATTICE.corners[:, 2] - LATTICE.corners[:, 0], LATTICE.corners[:, 3] - LATTICE.corners[:, 1]
        ),
        axis=1,
    )
    # 2 Σ length · mean chord of the file's trapezoids
    sections = AIRLINER.surfaces.wing.sections
    wing = 2.0 * sum(s.length_m * 0.5 * (s.chord_m[0] + s.chord_m[1]) for s in sections)
    assert area[LATTICE.surface == 0].sum() == pytest.approx(wing, rel=1e-9)


def test_the_lattice_is_its_own_mirror_image():
    two_sided = LATTICE.surface != LATTICE.surfaces.index("vertical_tail")
    points = {tuple(np.round(p, 9) + 0.0) for p in LATTICE.control[two_sided]}
    assert points == {tuple(np.round(p * [1.0, -1.0, 1.0], 9) + 0.0) for p in LATTICE.control[two_sided]}


def test_points_lie_on_their_panels_and_normals_across_them():
    np.testing.assert_allclose(np.linalg.norm(LATTICE.normal, axis=1), 1.0)
    assert np.all(LATTICE.corners[:, 0, 0] < LATTICE.control[:, 0])
    along = LATTICE.end - LATTICE.start
    across = np.cross([1.0, 0.0, 0.0], along)
    # turned from across by incidence and twist alone
    cosine = np.einsum("id,id->i", across, LATTICE.normal) / np.linalg.norm(across, axis=1)
    assert np.all(cosine > np.cos(np.radians(3.1)))


def test_hinges_belong_to_their_controls():
    moved = np.linalg.norm(LATTICE.hinge, axis=2) > 0.0
    assert np.all(LATTICE.control[moved[:, AILERON_LEFT], 1] < 0.0)
    assert np.all(LATTICE.control[moved[:, AILERON_RIGHT], 1] > 0.0)
    assert moved[:, INCIDENCE].sum() == (LATTICE.surface == LATTICE.surfaces.index("horizontal_tail")).sum()
    assert moved[:, ELEVATOR_LEFT].sum() == 10
    assert moved[:, RUDDER].sum() == 10
    span = np.abs(LATTICE.control[moved[:, AILERON_RIGHT], 1]) / (0.5 * AIRLINER.published.wing_span_m)
    assert np.all((span > 0.72) & (span < 0.95))


def test_a_body_of_revolution_between_a_sphere_and_a_needle():
    assert apparent_mass_difference(1.0001) == pytest.approx(0.0, abs=1e-3)
    # Munk, NACA Report 184: k₂ − k₁ = 0.778 at a slenderness of 4, 0.939 at 9.97
    assert apparent_mass_difference(3.99) == pytest.approx(0.778, abs=2e-3)
    assert apparent_mass_difference(9.97) == pytest.approx(0.939, abs=2e-3)


def test_mistakes_are_named():
    with pytest.raises(ValueError, match="5 parts of the span"):
        airliner_lattice(AIRLINER, PanelCounts(wing=(4, 2)))
    lattice = airliner_lattice(AIRLINER, FEW)
    zeros = np.zeros((len(lattice), 3, 7))
    motion = ModalMotion(zeros[..., :6], zeros[:28], zeros)
    with pytest.raises(ValueError, match=r"rotation has the shape \(28, 3, 7\)"):
        Airframe(lattice, motion, ReferenceDimensions(1.0, 1.0, 1.0), CENTRE_OF_GRAVITY)
    with pytest.raises(ValueError, match=r"Mach 0\.95"):
        mach_grid(0.4, 0.95)
    with pytest.raises(ValueError, match="low < high"):
        mach_grid(0.5, 0.4)
    with pytest.raises(ValueError, match="increasing"):
        fixed_machs([0.5, 0.4])
