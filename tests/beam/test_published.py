"""The beam against results that others published, and the order in which it gets there."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root
from structures import CANTILEVER, change

from flexsurr.beam import find_equilibrium, natural_modes, tip_position
from flexsurr.beam.rotation_vector import crosses
from flexsurr.config.along_span import AlongSpan, FixedMass
from flexsurr.config.load import TipForce
from flexsurr.config.structure import Structure

ROTATIONS = ("in_plane", "out_of_plane", "torsion")

# Patil's wing (1999), which bends in both planes and twists.
WING = Structure(
    name="Patil's wing",
    length_m=16.0,
    elements=16,
    joints=ROTATIONS,
    mass_per_length_kg_m=0.75,
    bending_stiffness_in_plane_N_m2=4e6,
    bending_stiffness_out_of_plane_N_m2=2e4,
    torsional_stiffness_N_m2=1e4,
    torsional_inertia_per_length_kg_m=0.1,
)


def loaded_wing(elements, joint_rotation):
    """The tip [m] and the first three frequencies [rad/s] under 20 N at the tip, upwards."""
    structure = change(WING, elements=elements, joint_rotation=joint_rotation)
    load = TipForce(force_N=20.0)
    q = find_equilibrium(structure, load)
    return tip_position(structure, q), natural_modes(structure, q, load)[0][:3]


def order(counts, errors):
    return -np.polyfit(np.log(counts), np.log(errors), 1)[0]


def test_sixteen_elements_are_within_a_thousandth_of_sixty_four():
    (tip, omega), (finer_tip, finer) = (loaded_wing(elements, "vector") for elements in (16, 64))
    assert np.abs(tip - finer_tip).max() < 1e-3 * WING.length_m
    np.testing.assert_allclose(omega, finer, rtol=1e-3)


def test_rotation_vectors_are_of_second_order_and_the_sequence_of_first():
    """The third frequency, torsion with bending in plane: what the elements are cut into decides it."""
    counts = (6, 8, 12, 16)
    exact = loaded_wing(96, "vector")[1]
    for joint_rotation, least, most in (("vector", 1.8, 2.3), ("sequence", 0.6, 1.4)):
        errors = [np.abs(loaded_wing(count, joint_rotation)[1] / exact - 1.0) for count in counts]
        assert least < order(counts, np.array(errors)[:, 2]) < most
    assert errors[-1][2] > 0.03


def bend(elements, joint_rotation="vector"):
    """A quarter of a right angle's arc: radius 100 in, section 1 in square, E = 1e7 psi, ν = 0."""
    modulus, length = 1e7, 25.0 * np.pi
    return Structure(
        name="45° bend",
        length_m=length,  # inches throughout, and pounds
        elements=elements,
        joints=(*ROTATIONS, "axial"),
        joint_rotation=joint_rotation,
        mass_per_length_kg_m=1.0,
        torsional_inertia_per_length_kg_m=1.0,
        bending_stiffness_in_plane_N_m2=modulus / 12.0,
        bending_stiffness_out_of_plane_N_m2=modulus / 12.0,
        torsional_stiffness_N_m2=modulus / 2.0 / 6.0,
        axial_stiffness_N=modulus,
        along_span=AlongSpan(stations_m=(0.0, length), axis_psi_deg=(0.0, 45.0)),
    )


def deflection(structure, load):
    """(3,) displacement of the tip under the load."""
    moved = tip_position(structure, find_equilibrium(structure, load))
    return moved - tip_position(structure, np.zeros(structure.coordinates))


def test_the_bend_of_bathe_and_bolourchi():
    """600 lb across its plane (Int. J. Numer. Methods Eng. 14, 1979), to 1 % of the displacement."""
    published = np.array([-23.5, -13.4, 53.4])
    found = deflection(bend(16), TipForce(force_N=600.0))
    assert np.linalg.norm(found - published) < 0.01 * np.linalg.norm(published)


def bend_as_a_rod():
    """(3,) the same displacement of the continuous rod: r' = (1 + n·d/EA) d, d' = κ × d, κ − κ₀ = m/EI.

    The force n is the same all along and the moment is that of n about s, (r(L) − r) × n: r(L) is found so
    that the integration from the clamp ends there. No shear, as the chain has none.
    """
    modulus, radius, force = 1e7, 100.0, np.array([0.0, 0.0, 600.0])
    stiffness = modulus * np.array([1.0 / 12.0, 1.0 / 12.0, 1.0 / 12.0])  # GJ and both EI

    def rate(_, y, tip):
        place, axes = y[:3], y[3:].reshape(3, 3)
        turn = axes.T @ np.cross(tip - place, force) / stiffness + [0.0, 0.0, 1.0 / radius]
        along = axes[:, 0] * (1.0 + axes[:, 0] @ force / modulus)
        return np.concatenate([along, (axes @ crosses(turn)).ravel()])

    def miss(tip):
        clamp = np.concatenate([np.zeros(3), np.eye(3).ravel()])
        found = solve_ivp(rate, (0.0, radius * np.pi / 4.0), clamp, args=(tip,), rtol=1e-9, atol=1e-10)
        return found.y[:3, -1] - tip

    unloaded = radius * np.array([np.sin(np.pi / 4.0), 1.0 - np.cos(np.pi / 4.0), 0.0])
    solved = root(miss, np.add(unloaded, [-23.0, -13.0, 53.0]))
    assert np.abs(solved.fun).max() < 1e-7
    return solved.x - unloaded


def test_the_bend_is_that_of_a_continuous_rod():
    """Each displacement within 0.1 %: so it is the published y, 13.4 in, that is 1.5 % short."""
    exact = bend_as_a_rod()
    np.testing.assert_allclose(deflection(bend(16), TipForce(force_N=600.0)), exact, rtol=1e-3)
    np.testing.assert_allclose(exact, [-23.5585, -13.6040, 53.4718], atol=1e-3)


def test_an_arc_is_of_second_order_too():
    exact = deflection(bend(64), TipForce(force_N=600.0))
    counts = (6, 8, 12, 16)
    errors = [np.abs(deflection(bend(count), TipForce(force_N=600.0)) - exact).max() for count in counts]
    assert 1.8 < order(counts, errors) < 2.3


@pytest.mark.parametrize(
    ("force", "along_width", "across"), [(8.896, 8.84e-3, 0.10899), (13.345, 0.015186, 0.15647)]
)
def test_the_princeton_beam_at_45_degrees(force, along_width, across):
    """Finite elements of the experiment of Dowell and Traybar (1975): tip along the width, across it [m]."""
    modulus, poisson, width, thickness = 71.7e9, 0.31, 12.3777e-3, 3.2024e-3
    ratio = thickness / width
    torsion = width * thickness**3 * (1.0 / 3.0 - 0.21 * ratio * (1.0 - ratio**4 / 12.0))  # Saint-Venant
    structure = Structure(
        name="Princeton beam",
        length_m=0.508,
        elements=16,
        joints=ROTATIONS,
        mass_per_length_kg_m=0.11,
        torsional_inertia_per_length_kg_m=1e-6,
        bending_stiffness_in_plane_N_m2=modulus * thickness * width**3 / 12.0,
        bending_stiffness_out_of_plane_N_m2=modulus * width * thickness**3 / 12.0,
        torsional_stiffness_N_m2=modulus / 2.0 / (1.0 + poisson) * torsion,
    )
    _, y, z = deflection(structure, TipForce(force_N=force, direction=(0.0, 1.0, 1.0)))
    assert y == pytest.approx(along_width, rel=0.01)
    assert z == pytest.approx(across, rel=0.01)


@pytest.mark.parametrize("share", [0.1, 1.0, 10.0])
def test_a_tip_mass_has_the_frequencies_of_its_characteristic_equation(share):
    """1 + cos λ cosh λ = α λ (sin λ cosh λ − cos λ sinh λ), α the tip's mass over the beam's."""

    def characteristic(z):
        return np.cos(z) + 1.0 / np.cosh(z) + share * z * (np.cos(z) * np.tanh(z) - np.sin(z))

    structure = change(
        CANTILEVER,
        elements=32,
        joint_rotation="vector",
        rotary_inertia="exact",
        point_masses=(FixedMass(at_m=1.0, mass_kg=share * 0.2),),
    )
    omega, _ = natural_modes(structure, np.zeros(32))
    roots = [brentq(characteristic, k * np.pi + 1e-6, (k + 1) * np.pi) for k in range(3)]
    np.testing.assert_allclose(omega[:3], np.square(roots) * np.sqrt(50.0 / 0.2), rtol=2e-3)


# λ of f = λ/(2π) h₁/L² √(E/(12 ρ)) for a thickness h that falls to a quarter, h₁, and a width that falls to a
# quarter or a fifth: H. H. Mabie and C. B. Rogers, J. Acoust. Soc. Am. 51 (1972), as in Code_Aster's SDLL09.
DOUBLE_TAPER = {4.0: (23.289, 73.9, 165.23), 5.0: (24.308, 75.56, 167.21)}


@pytest.mark.parametrize("narrowing", DOUBLE_TAPER)
def test_a_tapered_beams_frequencies(narrowing):
    share = np.linspace(0.0, 1.0, 101)
    thickness, width = 4.0 - 3.0 * share, 1.0 + (1.0 / narrowing - 1.0) * share
    structure = change(
        CANTILEVER,
        elements=32,
        mass_per_length_kg_m=None,
        bending_stiffness_out_of_plane_N_m2=None,
        along_span=AlongSpan(
            stations_m=tuple(share),
            mass_per_length_kg_m=tuple(width * thickness),
            bending_stiffness_out_of_plane_N_m2=tuple(width * thickness**3),  # E / (12 ρ) = 1
        ),
    )
    omega, _ = natural_modes(structure, np.zeros(32))
    np.testing.assert_allclose(omega[:3], DOUBLE_TAPER[narrowing], rtol=5e-3)


def test_a_table_of_one_value_is_that_value():
    table = AlongSpan(
        stations_m=(0.0, 0.3, 0.3, 1.0),
        mass_per_length_kg_m=(0.2,) * 4,
        bending_stiffness_out_of_plane_N_m2=(50.0,) * 4,
    )
    varying = change(
        CANTILEVER, mass_per_length_kg_m=None, bending_stiffness_out_of_plane_N_m2=None, along_span=table
    )
    uniform, found = (natural_modes(each, np.zeros(10))[0] for each in (CANTILEVER, varying))
    np.testing.assert_allclose(found, uniform, rtol=1e-10)


def test_a_stepped_beam_is_stepped_where_its_table_says():
    """Piecewise constant values, and a linear table with a jump, are one beam."""
    steps = change(
        CANTILEVER,
        mass_per_length_kg_m=None,
        along_span=AlongSpan(
            interpolation="constant", stations_m=(0.0, 0.33, 1.0), mass_per_length_kg_m=(0.3, 0.1, 9.0)
        ),
    )
    jump = change(
        steps,
        along_span=AlongSpan(stations_m=(0.0, 0.33, 0.33, 1.0), mass_per_length_kg_m=(0.3, 0.3, 0.1, 0.1)),
    )
    one, other = (natural_modes(each, np.zeros(10))[0] for each in (steps, jump))
    np.testing.assert_allclose(one, other, rtol=1e-12)
