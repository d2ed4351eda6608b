import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_bvp
from structures import ALL_JOINTS, CANTILEVER, change, structures

from flexsurr.beam import (
    DeadTipForce,
    DistributedForce,
    EquilibriumNotFound,
    SineTipForce,
    elastica_tip,
    find_equilibrium,
    tip_position,
)
from flexsurr.beam.equilibrium import static_residual

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
        tip = tip_position(structure, find_equilibrium(structure, DeadTipForce((0.0, 0.0, force))))
        errors.append(np.hypot(tip[0] - x, tip[2] - z))
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert 1.9 < order < 2.1
    assert errors[0] < 1e-3


def test_the_clamp_spring_makes_a_small_tip_load_exact():
    tip = tip_position(CANTILEVER, find_equilibrium(CANTILEVER, DeadTipForce((0.0, 0.0, 1e-6))))
    assert tip[2] == pytest.approx(1e-6 / 150.0, rel=1e-9)


@settings(max_examples=30)
@given(
    structures(),
    st.tuples(*[st.floats(-20.0, 20.0)] * 3).flatmap(
        lambda force: st.sampled_from([None, DeadTipForce(force), DistributedForce(force)])
    ),
)
def test_equilibria_balance_springs_and_loads(structure, load):
    q = find_equilibrium(structure, load)
    residual = static_residual(structure, q, load)
    assert np.abs(residual).max() <= 1e-9 * (1.0 + np.abs(static_residual(structure, 0.0 * q, load)).max())


def test_large_loads_are_reached_in_steps():
    q = find_equilibrium(CANTILEVER, DeadTipForce((-400.0, 0.0, 20.0)))
    assert np.abs(static_residual(CANTILEVER, q, DeadTipForce((-400.0, 0.0, 20.0)))).max() < 1e-8


def test_weight_bends_the_beam_as_its_distributed_force_does():
    """Without an offset the masses lie on the elastic axis at the elements' centres."""
    heavy = change(ALL_JOINTS, centre_of_gravity_offset_m=0.0)
    light = change(heavy, gravity_m_s2=0.0)
    weight = DistributedForce((0.0, 0.0, -9.81 * 0.4))
    np.testing.assert_allclose(find_equilibrium(heavy), find_equilibrium(light, weight), atol=1e-12)


def test_an_equilibrium_out_of_reach_is_an_error_in_one_line(monkeypatch):
    monkeypatch.setattr("flexsurr.beam.equilibrium._ITERATIONS", 1)
    message = r"cantilever: no static equilibrium beyond .* % of DeadTipForce.* residual"
    with pytest.raises(EquilibriumNotFound, match=message) as caught:
        find_equilibrium(CANTILEVER, DeadTipForce((0.0, 0.0, 150.0)))
    assert "\n" not in str(caught.value)


def test_a_load_that_changes_with_time_has_no_equilibrium():
    with pytest.raises(ValueError, match="changes with time"):
        find_equilibrium(CANTILEVER, SineTipForce(10.0, 50.0))


@pytest.mark.parametrize(
    "arguments", [(0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, 101.0), (1.0, 1.0, float("nan"))]
)
def test_the_elastica_refuses_what_it_cannot_do(arguments):
    with pytest.raises(ValueError, match=r"positive|beyond"):
        elastica_tip(*arguments)
