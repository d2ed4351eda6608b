import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_bvp
from structures import (
    ALL_JOINTS,
    CANTILEVER,
    any_structures,
    basis_of,
    change,
    tip_force,
    uniform_force,
)

from flexsurr.beam import (
    EquilibriumNotFound,
    elastica_tip,
    find_equilibrium,
    natural_modes,
    tip_position,
)
from flexsurr.beam.equilibrium import static_residual
from flexsurr.config.history import Power
from flexsurr.config.load import TipForce

LOADS = [10.0, 50.0, 100.0, 150.0]


@pytest.mark.parametrize("force", LOADS)
def test_elastica_is_the_solution_of_its_boundary_value_problem(force):
    """θ″ = −(F/EI) cos θ, θ(0) = 0, θ′(L) = 0, x′ = cos θ, z′ = sin θ."""

    def slopes(s, y):
        return np.vstack([y[1], -force / 50.0 * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])])

    def ends(clamp, tip):
        return np.array([clamp[0], tip[1], clamp[2], clamp[3]])

    s = np.linspace(0.0, 1.0, 50)
    found = solve_bvp(slopes, ends, s, np.zeros((4, s.size)), tol=1e-10, max_nodes=20000)
    np.testing.assert_allclose(elastica_tip(50.0, 1.0, force), found.y[2:, -1], rtol=0.0, atol=1e-9)


@given(st.floats(1e-12, 99.0))
def test_elastica_scales_and_reflects(load):
    x, z = elastica_tip(1.0, 1.0, load)
    np.testing.assert_allclose(elastica_tip(8.0, 2.0, 2.0 * load), [2.0 * x, 2.0 * z], rtol=1e-12)
    np.testing.assert_allclose(elastica_tip(1.0, 1.0, -load), [x, -z], rtol=1e-14)
    if load < 1e-5:
        np.testing.assert_allclose([x, z], [1.0, load / 3.0], rtol=1e-9)


@pytest.mark.parametrize("force", LOADS)
def test_full_order_statics_converge_to_the_elastica_at_second_order(force):
    x, z = elastica_tip(50.0, 1.0, force)
    counts = np.array([10, 20, 40, 80])
    errors = []
    for count in counts:
        structure = change(CANTILEVER, elements=int(count))
        tip = tip_position(structure, find_equilibrium(structure, tip_force(0.0, 0.0, force)))
        errors.append(np.hypot(tip[0] - x, tip[2] - z))
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert 1.9 < order < 2.1
    assert errors[0] < 1e-3


def test_the_clamp_spring_makes_a_small_tip_load_exact():
    tip = tip_position(CANTILEVER, find_equilibrium(CANTILEVER, tip_force(0.0, 0.0, 1e-6)))
    assert tip[2] == pytest.approx(1e-6 / 150.0, rel=1e-9)


@settings(max_examples=30)
@given(
    any_structures(),
    st.tuples(*[st.floats(-20.0, 20.0)] * 3).flatmap(
        lambda force: st.sampled_from([None, tip_force(*force), uniform_force(*force)])
    ),
)
def test_equilibria_balance_springs_and_loads(structure, load):
    q = find_equilibrium(structure, load)
    residual = static_residual(structure, q, load)
    assert np.abs(residual).max() <= 1e-9 * (1.0 + np.abs(static_residual(structure, 0.0 * q, load)).max())


def lifted(structure, load, modes=None):
    """The tip under F L²/EI = load along z, of the full-order model or of a reduced one."""
    force = tip_force(0.0, 0.0, 50.0 * load)
    if modes is None:
        return tip_position(structure, find_equilibrium(structure, force))
    basis = basis_of(structure, modes, "unit")
    return tip_position(structure, basis.modes @ find_equilibrium(basis, force))


@pytest.mark.parametrize("elements", [5, 10])
@pytest.mark.parametrize("modes", [None, 1, 3])
def test_a_larger_load_lifts_the_tip_further(elements, modes):
    """Full and reduced order keep to the elastica's branch, which is monotone, however large."""
    structure = change(CANTILEVER, elements=elements)
    heights = [lifted(structure, load, modes)[2] for load in np.linspace(0.0, 100.0, 41)]
    assert np.all(np.diff(heights) > 0.0)
    assert 0.8 < heights[-1] < 1.0


@pytest.mark.parametrize("load", [0.1, 1.0, 3.0, 5.0, 10.0, 10.5, 12.0, 20.0, 35.0, 50.0, 75.0, 100.0])
def test_the_error_against_the_elastica_is_of_second_order_at_every_load(load):
    """error(N) ≤ C/N² for every N, with the load's own C from the finest chain, and shrinking."""
    x, z = elastica_tip(50.0, 1.0, 50.0 * load)
    counts = np.array([5, 10, 20, 40, 80])
    tips = np.array([lifted(change(CANTILEVER, elements=int(count)), load) for count in counts])
    errors = np.hypot(tips[:, 0] - x, tips[:, 2] - z)
    assert np.all(errors * counts**2 <= 1.1 * errors[-1] * counts[-1] ** 2)
    assert np.all(np.diff(errors) < 0.0)


def test_a_strip_is_lifted_whose_load_no_root_finder_reached():
    strip = change(CANTILEVER, length_m=0.6, bending_stiffness_out_of_plane_N_m2=1.2)
    basis, force = basis_of(strip, 1), tip_force(0.0, 0.0, 40.0)
    assert tip_position(strip, basis.modes @ find_equilibrium(basis, force))[2] == pytest.approx(
        0.488, abs=1e-3
    )


def refusal(system, load=None):
    with pytest.raises(EquilibriumNotFound) as caught:
        find_equilibrium(system, load)
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("elements", [5, 10, 40])
def test_compression_is_borne_up_to_eulers_load(elements):
    structure = change(CANTILEVER, elements=elements)
    critical = np.pi**2 * 50.0 / 4.0
    np.testing.assert_array_equal(find_equilibrium(structure, tip_force(-0.99 * critical, 0.0, 0.0)), 0.0)
    for load in (1.01, 2.0, 30.0):
        message = refusal(structure, tip_force(-load * critical, 0.0, 0.0))
        found = float(re.match(r"cantilever: buckles at (\S+) N \(tip force\)", message)[1])
        assert found == pytest.approx(critical, rel=0.15 / elements**2 + 5e-4)


def test_a_reduced_column_buckles_later_for_it_can_bend_less_freely():
    force = tip_force(-400.0, 0.0, 0.0)
    critical = [
        float(re.search(r"buckles at (\S+) N", refusal(basis_of(CANTILEVER, modes), force))[1])
        for modes in (1, 2, 4, 10)
    ]
    assert np.all(np.diff(critical) <= 0.0)
    assert critical[0] > critical[-1]
    assert refusal(basis_of(CANTILEVER, 1), force).startswith("cantilever in 1 mode(s): buckles at 133.5 N")


def test_a_compressed_beam_that_is_bent_a_little_does_not_buckle():
    load = tip_force(-400.0, 0.0, 0.1)
    q = find_equilibrium(CANTILEVER, load)
    assert tip_position(CANTILEVER, q)[2] > 0.3
    assert natural_modes(CANTILEVER, q, load)[0][0] > 0.0


@pytest.mark.parametrize("weight", [1.0, 7.0, 8.5, 20.0])
def test_a_beam_hangs_from_its_clamp_and_stands_on_it_until_it_is_too_heavy(weight):
    """μ g L³/EI up to 7.837 (A. G. Greenhill, 1881)."""
    gravity = weight * 50.0 / 0.2
    hanging = change(CANTILEVER, elements=20, clamp_theta_deg=-90.0, gravity_m_s2=gravity)
    standing = change(hanging, clamp_theta_deg=90.0)
    np.testing.assert_allclose(find_equilibrium(hanging), 0.0, atol=1e-15)
    if weight < 7.8:
        np.testing.assert_allclose(find_equilibrium(standing), 0.0, atol=1e-15)
    else:
        message = refusal(standing)
        share = float(re.fullmatch(r"cantilever: buckles under (\S+) % of its own weight", message)[1])
        assert 0.01 * share * weight == pytest.approx(7.837, rel=1.5e-3)


def test_weight_and_load_that_buckle_together_are_told_together():
    standing = change(CANTILEVER, clamp_theta_deg=90.0, gravity_m_s2=9.81)
    message = refusal(standing, tip_force(0.0, 0.0, -200.0))
    assert re.fullmatch(r"cantilever: buckles at \S+ N \(.*\) under \S+ % of its own weight", message)


def test_three_hundred_rods_under_gravity_all_find_their_rest():
    random = np.random.default_rng(8)
    for _ in range(300):
        length, stiffness = random.uniform(0.2, 20.0), 10.0 ** random.uniform(-2.0, 4.0)
        weight = random.uniform(0.0, 60.0)  # μ g L³/EI
        rod = change(
            CANTILEVER,
            length_m=length,
            elements=int(random.integers(3, 13)),
            joints=("out_of_plane", "torsion") if random.random() < 0.3 else ("out_of_plane",),
            bending_stiffness_out_of_plane_N_m2=stiffness,
            torsional_stiffness_N_m2=stiffness,
            torsional_inertia_per_length_kg_m=0.1,
            mass_per_length_kg_m=weight * stiffness / (9.81 * length**3) + 1e-6,
            clamp_theta_deg=random.uniform(-90.0, 45.0),
            gravity_m_s2=9.81,
        )
        for system in (rod, basis_of(rod, int(random.integers(1, 4)))):
            eta = find_equilibrium(system)
            modes = np.eye(rod.coordinates) if system is rod else system.modes
            residual = modes.T @ static_residual(rod, modes @ eta)
            scale = np.linalg.norm(modes.T @ static_residual(rod, 0.0 * modes[:, 0]))
            assert np.linalg.norm(residual) <= 1e-10 * scale


def test_weight_bends_the_beam_as_its_distributed_force_does():
    """Without an offset the masses lie on the elastic axis at the elements' centres."""
    heavy = change(ALL_JOINTS, centre_of_gravity_offset_m=0.0)
    light = change(heavy, gravity_m_s2=0.0)
    weight = uniform_force(0.0, 0.0, -9.81 * 0.4)
    np.testing.assert_allclose(find_equilibrium(heavy), find_equilibrium(light, weight), atol=1e-12)


def test_a_load_that_changes_with_time_has_no_equilibrium():
    load = TipForce(force_N=10.0, history=Power(exponent=2, end_s=9.0))
    with pytest.raises(ValueError, match="changes with time"):
        find_equilibrium(CANTILEVER, load)
    held = find_equilibrium(CANTILEVER, load, at_s=3.0)
    np.testing.assert_allclose(held, find_equilibrium(CANTILEVER, tip_force(0.0, 0.0, 90.0)), rtol=1e-12)
    np.testing.assert_array_equal(find_equilibrium(CANTILEVER, load, at_s=9.0), 0.0)


@pytest.mark.parametrize(
    "arguments", [(0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, 101.0), (1.0, 1.0, float("nan"))]
)
def test_the_elastica_refuses_what_it_cannot_do(arguments):
    with pytest.raises(ValueError, match=r"positive|beyond"):
        elastica_tip(*arguments)
