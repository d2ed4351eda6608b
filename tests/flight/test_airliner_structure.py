"""The airliner's stick model and its free-free modes."""

import numpy as np
import pytest

from flexsurr.config.aircraft import Aircraft
from flexsurr.flight import free_modes, mass_properties, stick_model, surface_motion
from flexsurr.flight.modes import mirrored

# Reference frequencies of a stick model with the same stiffness and masses [Hz].
REFERENCE_HZ = [2.23, 2.84, 3.09, 3.87, 4.50, 4.58, 6.35, 6.49]


def test_it_weighs_and_measures_what_is_published(gnba, gnba_modes):
    skeleton = gnba_modes.model.skeleton
    found = mass_properties(skeleton)
    assert found.mass == pytest.approx(gnba.published.mass_kg, abs=1e-6)
    assert np.ptp(skeleton.nodes[:, 1]) == pytest.approx(gnba.published.wing_span_m, abs=0.01)
    on_axis = skeleton.nodes[(skeleton.nodes[:, 1] == 0.0) & (skeleton.nodes[:, 2] == gnba.fuselage.axis_z_m)]
    assert np.ptp(on_axis[:, 0]) == pytest.approx(gnba.published.fuselage_length_m)
    assert found.centre_of_gravity[1] == pytest.approx(0.0, abs=1e-9)
    masses = dict.fromkeys(("fuel", "engine", "fuselage and systems"), 0.0)
    for lump in skeleton.masses:
        if lump.part in masses:
            masses[lump.part] += lump.mass
    assert masses == pytest.approx({"fuel": 11000.0, "engine": 5800.0, "fuselage and systems": 15764.0})
    shell = [lump for lump in skeleton.masses if lump.part == "fuselage and systems"]
    centroid = sum(lump.mass * lump.position[0] for lump in shell) / 15764.0
    assert centroid == pytest.approx(gnba.mass.fuselage_and_systems.centroid_x_m, abs=0.01)


def test_every_lump_is_a_possible_rigid_body(gnba_modes):
    for lump in gnba_modes.model.skeleton.masses:
        moments = np.linalg.eigvalsh(lump.inertia)
        assert moments[0] >= -1e-9
        assert moments[2] <= (moments[0] + moments[1]) * (1.0 + 1e-9) + 1e-9


def test_six_rigid_body_modes_at_zero_within_rounding(gnba_modes):
    assert len(gnba_modes.rigid_body_rad_s) == 6
    assert gnba_modes.rigid_body_rad_s.max() < 1e-4 * gnba_modes.omega_rad_s[0]
    skeleton = gnba_modes.model.skeleton
    stiffness = skeleton.stiffness_matrix()
    motions = skeleton.rigid_body_motions(gnba_modes.properties.centre_of_gravity)
    assert np.abs(stiffness @ motions).max() < 1e-13 * np.abs(stiffness).max()
    mass = motions.T @ skeleton.mass_matrix() @ motions
    assert mass[:3, :3] == pytest.approx(55764.0 * np.eye(3), abs=1e-6)
    assert mass[3:, 3:] == pytest.approx(gnba_modes.properties.inertia, rel=1e-9, abs=1e-3)


def test_elastic_frequencies_lie_near_the_reference(gnba_modes):
    assert gnba_modes.frequency_hz == pytest.approx(REFERENCE_HZ, rel=0.05)


def test_modes_are_mass_normalised_in_mean_axes_and_symmetric_or_antisymmetric(gnba_modes):
    skeleton = gnba_modes.model.skeleton
    mass, stiffness = skeleton.mass_matrix(), skeleton.stiffness_matrix()
    shapes = gnba_modes.shapes
    assert shapes.T @ mass @ shapes == pytest.approx(np.eye(8), abs=1e-8)
    assert shapes.T @ stiffness @ shapes == pytest.approx(np.diag(gnba_modes.omega_rad_s**2), abs=1e-4)
    momenta = skeleton.rigid_body_motions(gnba_modes.properties.centre_of_gravity).T @ mass @ shapes
    assert np.abs(momenta).max() < 1e-6
    images = mirrored(skeleton.nodes, shapes)
    signs = np.where(gnba_modes.symmetric, 1.0, -1.0)
    assert images == pytest.approx(shapes * signs, abs=1e-7)
    assert gnba_modes.symmetric[0]
    tip = gnba_modes.model.lines["wing", "right"][-1].nodes[1]
    assert shapes[6 * tip + 2, 0] > 0.0


def test_stiffening_everything_four_times_doubles_every_frequency(gnba, gnba_modes):
    content = gnba.model_dump(mode="json")

    def scale(node: dict[str, object]) -> None:
        for key, value in node.items():
            if isinstance(value, dict):
                scale(value)
            elif "stiffness_N" in key:
                node[key] = [4.0 * v for v in value] if isinstance(value, list) else 4.0 * value

    scale(content["stiffness"])
    stiffer = free_modes(stick_model(Aircraft.model_validate(content)), 8)
    assert stiffer.frequency_hz == pytest.approx(2.0 * gnba_modes.frequency_hz, rel=1e-6)


def test_points_of_a_surface_follow_its_elastic_axis_by_rigid_arms(gnba_modes):
    model = gnba_modes.model
    tip = model.lines["wing", "right"][-1].nodes[1]
    node = model.skeleton.nodes[tip]
    arms = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-0.5, 0.0, 0.3]])
    translation, rotation = surface_motion(gnba_modes, "wing", node + arms)
    motion = gnba_modes.shapes.reshape(-1, 6, 8)[tip]
    assert translation[:, :, 0] == pytest.approx(motion[:3].T)
    assert rotation[:, :, 2] == pytest.approx(motion[3:].T)
    for k in range(8):
        assert translation[k, :, 1] - translation[k, :, 0] == pytest.approx(np.cross(motion[3:, k], arms[1]))


@pytest.mark.parametrize("surface", ["wing", "horizontal_tail"])
def test_both_halves_of_a_surface_move_as_images(gnba_modes, surface):
    points = np.array([[16.0, 0.7, -0.9], [18.5, 6.0, 0.0], [36.0, 3.0, 1.0]])
    image = np.array([1.0, -1.0, 1.0])
    right = surface_motion(gnba_modes, surface, points)
    left = surface_motion(gnba_modes, surface, points * image)
    signs = np.where(gnba_modes.symmetric, 1.0, -1.0)[:, None, None]
    assert left[0] == pytest.approx(signs * right[0] * image[:, None], abs=1e-8)
    assert left[1] == pytest.approx(-signs * right[1] * image[:, None], abs=1e-8)


def test_too_many_modes_are_refused(gnba_modes):
    with pytest.raises(ValueError, match="modes asked; allowed: 1 to"):
        free_modes(gnba_modes.model, 10000)
