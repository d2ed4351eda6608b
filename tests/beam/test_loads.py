import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.integrate import fixed_quad, quad, solve_bvp
from structures import (
    ALL_JOINTS,
    CANTILEVER,
    SEEDS,
    SUBSETS,
    any_structures,
    basis_of,
    change,
    coordinates,
    state,
    structures,
    tip_force,
    uniform_force,
)
from test_implementations import assert_close

from flexsurr.beam import (
    find_equilibrium,
    full_order,
    load_forces,
    loaded,
    natural_modes,
    reduced_order,
    tip_position,
)
from flexsurr.beam.chain import chain
from flexsurr.beam.equilibrium import static_residual, tangent_stiffness
from flexsurr.beam.kinematics import configuration
from flexsurr.beam.loads import Forces, Part, acting, load_breakpoints, load_ends_s, load_parts
from flexsurr.config.history import (
    Constant,
    OneMinusCosine,
    Power,
    Ramp,
    Sine,
    SmoothRamp,
    Table,
    with_table,
)
from flexsurr.config.load import (
    ClampAcceleration,
    DistributedForce,
    DistributedMoment,
    MomentSpread,
    SeveralLoads,
    Spread,
    TipForce,
    TipMoment,
)
from flexsurr.config.structure import Structure
from flexsurr.config.study import Integrator
from flexsurr.simulation import CompiledModel, simulate
from flexsurr.simulation.history import (
    breakpoints,
    end_s,
    factor,
    histories_kernel,
    history_factor,
    history_integral,
    history_slope,
    integral,
    slope,
    start_s,
)

KINDS = ("described", "numpy", "compiled")
VECTORS = st.tuples(*[st.floats(-20.0, 20.0)] * 3).filter(any)
TIMES = np.linspace(0.0, 3.0, 301)
HISTORIES = st.one_of(
    st.just(Constant()),
    st.floats(0.1, 50.0).map(lambda w: Sine(frequency_rad_s=w, phase_rad=0.3, end_s=2.0)),
    st.integers(1, 4).map(lambda n: Power(exponent=n, reference_s=0.8, start_s=0.5)),
    st.floats(0.1, 3.0).map(lambda rise: Ramp(start_s=0.4, rise_s=rise)),
    st.floats(0.1, 3.0).map(lambda rise: SmoothRamp(start_s=0.3, rise_s=rise, end_s=2.8)),
    st.floats(0.5, 3.0).map(lambda duration: OneMinusCosine(start_s=0.2, duration_s=duration)),
    st.floats(0.1, 9.0).map(lambda w: Table(times_s=TIMES, factors=np.cos(w * TIMES), start_s=0.1)),
)


def single_loads():
    """Every kind of load, each with any history."""

    def spreads(v, record=Spread):
        size = next(iter(record.model_fields))
        shapes = ("uniform", "one_minus_elliptic", "elliptic")
        return [record(**{size: part, "shape": shape}) for part, shape in zip(v, shapes, strict=True)]

    def along(v, follows, history, place):
        x, y, z = spreads(v)
        span = {"from_m": 0.1, "to_m": 1.0, "acts_on": place}
        return DistributedForce(along_x=x, along_y=y, along_z=z, follows=follows, history=history, **span)

    def about(v, follows, history):
        x, y, z = spreads(v, MomentSpread)
        return DistributedMoment(about_x=x, about_y=y, about_z=z, follows=follows, history=history, to_m=0.9)

    def shaken(v, history):
        return ClampAcceleration(acceleration_m_s2=3.0, direction=v, history=history)

    follows = st.booleans()
    return st.one_of(
        st.builds(
            lambda v, f, h: TipForce(force_N=7.0, direction=v, follows=f, history=h),
            VECTORS,
            follows,
            HISTORIES,
        ),
        st.builds(
            lambda v, f, h: TipMoment(moment_N_m=5.0, direction=v, follows=f, history=h),
            VECTORS,
            follows,
            HISTORIES,
        ),
        st.builds(along, VECTORS, follows, HISTORIES, st.sampled_from(["span", "tip"])),
        st.builds(about, VECTORS, follows, HISTORIES),
        st.builds(shaken, VECTORS, HISTORIES),
    )


LOADS = st.one_of(
    single_loads(), st.lists(single_loads(), min_size=1, max_size=3).map(lambda ls: SeveralLoads(loads=ls))
)
WING = Structure(**yaml.safe_load((Path(__file__).parents[2] / "config/structures/wing.yaml").read_text()))
LIFT_AND_DRAG = DistributedForce(
    along_y=Spread(force_N_m=0.5, shape="one_minus_elliptic"),
    along_z=Spread(force_N_m=2.0, shape="elliptic"),
    history=Power(exponent=2, end_s=5.0),
)


@settings(max_examples=40)
@given(any_structures(), LOADS, SEEDS)
def test_the_three_implementations_agree(structure, load, seed):
    for system, model in ((structure, full_order), (basis_of(structure), reduced_order)):
        models = [loaded(model(system, "hamiltonian", kind), system, load, kind) for kind in KINDS]
        x = state(system, seed)
        expected = models[0].derivative(1.0, x)
        assert_close(models[1].derivative(1.0, x), expected)
        assert_close(models[2].derivative(1.0, x), expected)


@given(any_structures(), VECTORS, SEEDS)
def test_loads_do_virtual_work(structure, force, seed):
    """Q is the derivative of the work of the dead forces, here by a complex step."""
    basis = basis_of(structure)
    r = len(basis.omega_rad_s)
    eta = np.random.default_rng(seed).uniform(-0.5, 0.5, r)
    q = (eta + 1e-30j * np.eye(r)) @ basis.modes.T
    at = configuration(chain(structure), q)
    length = chain(structure).element_length
    works = {
        tip_force(*force): at.nodes[..., -1, :] @ force,
        uniform_force(*force): length * at.centres.sum(axis=-2) @ force,
    }
    x = np.concatenate([eta, np.zeros(r)])
    for load, work in works.items():
        model = reduced_order(basis, "hamiltonian", "compiled")
        added = loaded(model, basis, load, "compiled").derivative(0.0, x) - model.derivative(0.0, x)
        np.testing.assert_allclose(added[:r], 0.0)
        scale = np.abs(model.derivative(0.0, x)).max() + np.abs(work.imag / 1e-30).max()
        np.testing.assert_allclose(added[r:], work.imag / 1e-30, rtol=0.0, atol=1e-12 * scale)


def force_at(structure, q, part):
    """Q (n,) of one part at a factor of 1."""
    beam = chain(structure)
    return acting(beam.elements, [part], [1.0]).generalised(beam, configuration(beam, q))


def work_along(structure, part, path, slope):
    """∫ Q · dq from 0 to 1 by Gauss and Legendre's rule of 24 points."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    return sum(
        0.5 * w * force_at(structure, path(0.5 * (s + 1.0)), part) @ slope(0.5 * (s + 1.0))
        for s, w in zip(nodes, weights, strict=True)
    )


@pytest.mark.parametrize("follows", [False, True])
def test_the_work_of_a_dead_force_does_not_depend_on_the_path(follows):
    """It is F · Δr; a force that follows does another work on another path."""
    end = coordinates(ALL_JOINTS, 3)
    detour = coordinates(ALL_JOINTS, 4)
    (part,) = load_parts(ALL_JOINTS, TipForce(force_N=5.0, direction=(1.0, 2.0, -2.0), follows=follows))
    works = [
        work_along(ALL_JOINTS, part, lambda s: s * end, lambda s: end),
        work_along(
            ALL_JOINTS,
            part,
            lambda s: s * end + np.sin(np.pi * s) * detour,
            lambda s: end + np.pi * np.cos(np.pi * s) * detour,
        ),
    ]
    moved = tip_position(ALL_JOINTS, end) - tip_position(ALL_JOINTS, 0.0 * end)
    if follows:
        assert abs(works[0] - works[1]) > 0.01
    else:
        np.testing.assert_allclose(works, part.forces.on_tip @ moved, rtol=1e-10)


@given(structures(), VECTORS, SEEDS)
def test_what_follows_does_not_know_how_the_clamp_is_turned(structure, direction, seed):
    q, turned = coordinates(structure, seed), change(structure, clamp_psi_deg=77.0, clamp_phi_deg=-160.0)
    for load in (
        TipForce(force_N=3.0, direction=direction, follows=True),
        TipMoment(moment_N_m=3.0, direction=direction, follows=True),
        DistributedForce(along_z=Spread(force_N_m=4.0), follows=True),
    ):
        found, expected = (force_at(each, q, load_parts(each, load)[0]) for each in (turned, structure))
        np.testing.assert_allclose(found, expected, atol=1e-12)


@given(structures(), VECTORS, SEEDS)
def test_a_moment_is_two_opposite_forces_on_one_element(structure, force, seed):
    """F on the tip and −f on the last centre, half an element apart, turn it as (l/2 e_x) × f does."""
    q, beam = coordinates(structure, seed), chain(structure)
    pair = Forces.none(structure.elements)
    pair.on_tip[:], pair.on_centres[-1] = force, -np.array(force)
    moment = np.cross([0.5 * beam.element_length, 0.0, 0.0], force)
    couple = Forces.none(structure.elements)
    couple.couples[-1] = moment
    found, expected = (force_at(structure, q, Part(each, True, Constant())) for each in (couple, pair))
    np.testing.assert_allclose(found, expected, atol=1e-11 * np.abs(force).max())


@settings(max_examples=30)
@given(structures(gravity_m_s2=0.0), SEEDS)
def test_a_clamp_that_rises_ever_faster_weighs_as_gravity_does(structure, seed):
    x = state(structure, seed)
    heavy = full_order(change(structure, gravity_m_s2=3.7), "hamiltonian", "numpy").derivative(0.0, x)
    for kind in ("numpy", "compiled"):
        free = full_order(structure, "hamiltonian", kind)
        lifted = loaded(free, structure, ClampAcceleration(acceleration_m_s2=3.7), kind)
        assert_close(lifted.derivative(0.0, x), heavy)


@pytest.mark.parametrize("follows", [False, True])
@pytest.mark.parametrize("part_of_circle", [0.25, 0.7])
def test_a_moment_at_the_tip_bends_the_beam_to_a_circle(follows, part_of_circle):
    """Curvature M/EI, of second order in 1/N."""
    angle = 2.0 * np.pi * part_of_circle
    expected = np.array([np.sin(angle), 0.0, 1.0 - np.cos(angle)]) / angle
    errors = []
    for elements in (10, 20, 40):
        structure = change(CANTILEVER, elements=elements)
        tip = tip_position(
            structure, find_equilibrium(structure, TipMoment(moment_N_m=50.0 * angle, follows=follows))
        )
        errors.append(np.linalg.norm(tip - expected))
    assert errors[2] < 2e-3
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.3 * errors[1]


def test_a_moment_of_2_pi_ei_over_l_closes_the_circle():
    q = find_equilibrium(CANTILEVER, TipMoment(moment_N_m=100.0 * np.pi, follows=True))
    np.testing.assert_allclose(tip_position(CANTILEVER, q), 0.0, atol=0.02)


def test_force_moment_and_what_follows_at_once_bend_the_chain_as_the_continuous_beam():
    """EI θ″ = −F cos θ − (L − s) w, θ′(L) = M/EI: a force, a pressure w normal to the beam, and a moment.

    The pressure beyond s has the moment about s of its own resultant: both are integrated along.
    """
    force, pressure, moment = 30.0, 40.0, -12.0

    def slopes(s, y):
        angle, curvature, _, _, across_x, across_z = y
        shear = force * np.cos(angle) + across_x * -np.sin(angle) + across_z * np.cos(angle)
        return np.vstack(
            [
                curvature,
                -shear / 50.0,
                np.cos(angle),
                np.sin(angle),
                pressure * np.sin(angle),  # the resultant of what lies outboard shrinks along s
                -pressure * np.cos(angle),
            ]
        )

    def ends(clamp, tip):
        return np.array([clamp[0], clamp[2], clamp[3], tip[1] - moment / 50.0, tip[4], tip[5]])

    found = solve_bvp(slopes, ends, np.linspace(0.0, 1.0, 60), np.zeros((6, 60)), tol=1e-9, max_nodes=20000)
    assert found.success
    load = SeveralLoads(
        loads=(
            TipForce(force_N=force),
            DistributedForce(along_z=Spread(force_N_m=pressure), follows=True),
            TipMoment(moment_N_m=moment),
        )
    )
    errors = []
    for elements in (10, 20, 40):
        structure = change(CANTILEVER, elements=elements)
        q = find_equilibrium(structure, load)
        assert np.abs(static_residual(structure, q, load)).max() < 1e-9
        errors.append(np.linalg.norm(tip_position(structure, q)[[0, 2]] - found.y[2:4, -1]))
    assert errors[2] < 5e-4
    assert errors[2] < 0.3 * errors[1] < 0.1 * errors[0]


def test_only_a_load_with_a_potential_has_a_symmetric_tangent_and_real_modes():
    q = coordinates(ALL_JOINTS, 5)
    for load, symmetric in (
        (TipForce(force_N=5.0), True),
        (ClampAcceleration(acceleration_m_s2=5.0), True),
        (TipForce(force_N=5.0, follows=True), False),
        (TipMoment(moment_N_m=5.0), False),
    ):
        tangent = tangent_stiffness(ALL_JOINTS, q, load)
        assert np.allclose(tangent, tangent.T, atol=1e-9) == symmetric
        if not symmetric:
            with pytest.raises(ValueError, match="no real modes"):
                natural_modes(ALL_JOINTS, q, load)


SHAPES = {
    "uniform": lambda x: 1.0,
    "linear": lambda x: x,
    "elliptic": lambda x: np.sqrt(1.0 - x * x),
    "one_minus_elliptic": lambda x: 1.0 - np.sqrt(1.0 - x * x),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_elements_receive_the_integral_over_their_own_span(shape):
    structure = change(CANTILEVER, elements=7)
    load = DistributedForce(along_y=Spread(force_N_m=3.0, shape=shape), from_m=0.25, to_m=0.9)
    forces = load_forces(structure, load)
    for i in range(7):
        low, high = np.clip([i / 7, (i + 1) / 7], 0.25, 0.9)
        integral = quad(SHAPES[shape], low, high)[0]
        np.testing.assert_allclose(forces.on_centres[i], [0.0, 3.0 * integral, 0.0], atol=1e-12)
    assert not forces.on_tip.any()
    at_the_tip = load_forces(structure, load.model_copy(update={"acts_on": "tip"}))
    assert not at_the_tip.on_centres.any()
    np.testing.assert_allclose(at_the_tip.on_tip, forces.on_centres.sum(axis=0), rtol=1e-14)


@pytest.mark.parametrize("acts_on", ["span", "tip"])
def test_the_papers_forces_are_43_and_628_newtons_at_5_seconds(acts_on):
    """Eqs. 13 and 14: 0.5 t² L (1 − π/4) along y, 2 t² L π/4 along z."""
    load = LIFT_AND_DRAG.model_copy(update={"acts_on": acts_on})
    forces = load_forces(WING, load)
    total = 25.0 * (forces.on_centres.sum(axis=0) + forces.on_tip)
    np.testing.assert_allclose(
        total, [0.0, 200.0 * (1.0 - np.pi / 4.0), 200.0 * np.pi], rtol=1e-12, atol=1e-12
    )
    np.testing.assert_allclose(total[1:], [43.0, 628.0], atol=0.5)
    assert factor(load.history, np.nextafter(5.0, 0.0)) == pytest.approx(25.0)
    assert factor(load.history, 5.0) == 0.0


@pytest.mark.parametrize(
    ("shape", "expected"), [("elliptic", [12.676, 9.150]), ("uniform", [11.566, 10.274])]
)
def test_628_newtons_of_lift_bend_the_chain_as_they_bend_the_continuous_wing(shape, expected):
    """EI θ″ = −V(s) cos θ with V the lift outboard; the same lift spread evenly bends further."""
    planar = change(WING, joints=("out_of_plane",))
    spread = Spread(force_N_m=50.0 if shape == "elliptic" else 12.5 * np.pi, shape=shape)

    def outboard(s):
        xi = s / 16.0
        rest = 0.5 * np.pi - xi * np.sqrt(np.maximum(0.0, 1.0 - xi**2)) - np.arcsin(np.minimum(1.0, xi))
        return 400.0 * rest if shape == "elliptic" else 200.0 * np.pi * (1.0 - xi)

    def slopes(s, y):
        return np.vstack([y[1] / 2e4, -outboard(s) * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])])

    def ends(clamp, tip):
        return np.array([clamp[0], tip[1], clamp[2], clamp[3]])

    found = solve_bvp(slopes, ends, np.linspace(0.0, 16.0, 60), np.zeros((4, 60)), tol=1e-8, max_nodes=20000)
    np.testing.assert_allclose(found.y[2:, -1], expected, atol=1e-3)
    load = DistributedForce(along_z=spread)
    errors = []
    for elements in (16, 32):
        structure = change(planar, elements=elements)
        tip = tip_position(structure, find_equilibrium(structure, load))
        errors.append(np.linalg.norm(tip[[0, 2]] - found.y[2:, -1]))
    assert errors[0] < 0.1
    assert errors[1] < 0.3 * errors[0]


def test_held_at_5_seconds_they_bend_full_and_reduced_wing_alike():
    at_s = np.nextafter(5.0, 0.0)
    tip = tip_position(WING, find_equilibrium(WING, LIFT_AND_DRAG, at_s))
    basis = basis_of(WING, 3)
    eta = find_equilibrium(basis, LIFT_AND_DRAG, at_s)
    np.testing.assert_allclose(tip[[0, 2]], [12.62, 9.18], atol=0.01)
    np.testing.assert_allclose(tip_position(WING, basis.modes @ eta)[[0, 2]], tip[[0, 2]], atol=0.05)
    assert eta[0] == pytest.approx(17.67, abs=0.01)


def test_the_work_of_a_load_that_grows_is_the_energy_gained():
    """Undamped: H(t) − H(0) = ∫ Q · η̇ dt, here by Simpson's rule over a fine response."""
    structure = change(CANTILEVER, elements=4)
    basis = basis_of(structure, 2)
    free = reduced_order(basis, "hamiltonian", "numpy")
    load = TipForce(force_N=30.0, direction=(-0.3, 0.0, 1.0), history=Power(exponent=2, reference_s=0.1))
    model = loaded(reduced_order(basis, "hamiltonian", "compiled"), basis, load, "compiled")
    t = np.linspace(0.0, 0.2, 2001)
    x = simulate(model, t, np.zeros(4), Integrator(method="scipy_dop853", rtol=1e-11, atol=1e-13)).x
    powers = [
        (model.derivative(now, at)[2:] - free.derivative(now, at)[2:]) @ free.derivative(now, at)[:2]
        for now, at in zip(t, x, strict=True)
    ]
    weights = np.full(t.size, 2.0)
    weights[1::2], weights[[0, -1]] = 4.0, 1.0
    gained = free.energy(x[-1]) - free.energy(x[0])
    assert gained > 1.0
    assert weights @ powers * (t[1] - t[0]) / 3.0 == pytest.approx(gained, rel=1e-6)


@given(st.lists(HISTORIES, min_size=1, max_size=3), st.floats(0.0, 3.5))
def test_histories_are_the_same_compiled(histories, t):
    kernel = histories_kernel(histories)
    for k, history in enumerate(histories):
        assert history_factor(kernel, k, t) == pytest.approx(factor(history, t), rel=1e-12, abs=1e-13)
        assert history_slope(kernel, k, t) == pytest.approx(slope(history, t), rel=1e-11, abs=1e-11)
        assert history_integral(kernel, k, t) == pytest.approx(integral(history, t), rel=1e-11, abs=1e-12)


@given(HISTORIES, st.floats(0.01, 3.5))
def test_slope_and_integral_of_a_history_are_those_of_its_factor(history, t):
    def area(low, high):
        low, high = max(low, start_s(history)), min(high, end_s(history))
        inside = [*breakpoints(history), *(TIMES if isinstance(history, Table) else ())]
        knots = [low, *sorted(time for time in inside if low < time < high), high]
        pieces = pairwise(knots)
        # inside of each piece, so that nothing is seen of a jump at its end
        return sum(
            fixed_quad(np.vectorize(lambda s: factor(history, s)), a, b, n=40)[0] for a, b in pieces if b > a
        )

    assert integral(history, t) == pytest.approx(area(0.0, t), rel=1e-8, abs=1e-10)
    near = [t - 1e-6, t + 1e-6]
    within = start_s(history) < near[0] and near[1] < end_s(history)
    if within and not any(near[0] <= time <= near[1] for time in (*breakpoints(history), *TIMES)):
        rise = factor(history, near[1]) - factor(history, near[0])
        assert slope(history, t) == pytest.approx(rise / 2e-6, rel=1e-5, abs=1e-5)


def test_a_bump_integrates_to_its_impulse():
    """Half its height times its duration; a soft beam at rest receives just that momentum."""
    bump = OneMinusCosine(start_s=0.3, duration_s=1.7)
    assert quad(lambda t: factor(bump, t), 0.0, 3.0, points=(0.3, 2.0))[0] == pytest.approx(0.85, rel=1e-8)
    basis, short = basis_of(CANTILEVER, 1), OneMinusCosine(duration_s=1e-4)
    model = reduced_order(basis, "hamiltonian", "compiled")
    under = loaded(model, basis, TipForce(force_N=20.0, history=short), "compiled")
    x = simulate(under, np.linspace(0.0, 2e-4, 3), np.zeros(2), Integrator(method="rk4", step_s=1e-6)).x[-1]
    push = under.derivative(0.5e-4, np.zeros(2)) - model.derivative(0.0, np.zeros(2))
    assert x[1] == pytest.approx(0.5e-4 * push[1], rel=1e-3)


def test_a_table_of_a_sine_is_the_sine_within_what_straight_lines_err_by():
    """At most (ω h)²/8; a beam shaken by either moves alike."""
    omega, times = 30.0, np.linspace(0.0, 1.0, 1001)
    sine, table = Sine(frequency_rad_s=omega), Table(times_s=times, factors=np.sin(omega * times))
    between = np.linspace(0.0, 0.9999, 3777)
    off = [factor(sine, t) - factor(table, t) for t in between]
    assert 1e-5 < np.abs(off).max() <= (omega * 1e-3) ** 2 / 8.0
    basis = basis_of(CANTILEVER, 1)
    model = reduced_order(basis, "hamiltonian", "compiled")
    tips = []
    for history in (sine, table):
        under = loaded(model, basis, TipForce(force_N=10.0, history=history), "compiled")
        found = simulate(under, times[::10], np.zeros(2), Integrator(method="rk4", step_s=5e-4))
        tips.append(under.tip(found.x))
    np.testing.assert_allclose(tips[1], tips[0], atol=2e-4 * np.abs(tips[0][:, 2]).max())


def test_a_table_is_read_from_its_file(tmp_path):
    (tmp_path / "gust.csv").write_text("t_s,factor\n0.5,1.0\n1.5,3.0\n2.0,-1.0\n")
    load = TipForce(force_N=2.0, history=Table(file="gust.csv", end_s=1.8)).with_tables(tmp_path)
    history = load.history
    assert (history.file, history.times_s, history.factors) == (None, (0.5, 1.5, 2.0), (1.0, 3.0, -1.0))
    assert [factor(history, t) for t in (0.0, 0.5, 1.0, 1.75, 1.8)] == [0.0, 1.0, 2.0, 1.0, 0.0]
    assert breakpoints(history) == (0.5, 1.8)
    several = SeveralLoads(
        loads=(TipForce(force_N=2.0), TipForce(force_N=1.0, history=Table(file="gust.csv")))
    )
    assert load_ends_s(several.with_tables(tmp_path).loads[1]) == 2.0


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "'gust.csv' cannot be read"),
        ("time,factor\n0,1\n1,1\n", "its header is 'time,factor'; allowed: t_s,factor"),
        ("t_s,factor\n0,1\n", "1 rows are no table"),
        ("t_s,factor\n0,1\n1,x\n", "row 3 is '1,x'; allowed: two numbers"),
        ("t_s,factor\n0,1\n1,2,3\n", "row 3 is '1,2,3'"),
        ("t_s,factor\n0,1\n0,2\n", "gust.csv: times_s: 0 after 0 is not allowed; allowed: increasing"),
        ("t_s,factor\n0,1\n1,nan\n", "gust.csv: Input should be a finite number"),
        ("", "its header is ''"),
    ],
)
def test_a_file_that_is_no_table_is_refused(tmp_path, content, words):
    if content is not None:
        (tmp_path / "gust.csv").write_text(content)
    with pytest.raises(ValueError, match=re.escape(words)) as caught:
        with_table(Table(file="gust.csv"), tmp_path)
    assert "\n" not in str(caught.value)


def test_histories_are_what_their_names_say():
    assert factor(Constant(), 7.0) == 1.0
    assert factor(Sine(frequency_rad_s=50.0), 0.02) == pytest.approx(np.sin(1.0))
    assert factor(Power(exponent=2), 3.0) == 9.0
    assert factor(Power(exponent=3, reference_s=2.0), 4.0) == 8.0
    assert breakpoints(Constant(start_s=1.0)) == (1.0,)
    ramp = Ramp(start_s=1.0, rise_s=2.0, end_s=5.0)
    assert [factor(ramp, t) for t in (0.9, 1.0, 2.0, 3.0, 4.9, 5.0)] == [0.0, 0.0, 0.5, 1.0, 1.0, 0.0]
    assert breakpoints(ramp) == (1.0, 3.0, 5.0)
    smooth = SmoothRamp(start_s=1.0, rise_s=2.0)
    assert [factor(smooth, t) for t in (0.9, 1.0, 2.0, 3.0, 4.0)] == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0])
    assert [slope(smooth, t) for t in (1.0, 2.0, 3.0)] == pytest.approx([0.0, 1.0, 0.0])
    assert breakpoints(smooth) == (1.0, 3.0)
    bump = OneMinusCosine(start_s=1.0, duration_s=2.0)
    assert [factor(bump, t) for t in (0.9, 1.0, 2.0, 3.0)] == pytest.approx([0.0, 0.0, 1.0, 0.0])
    assert (breakpoints(bump), end_s(bump)) == ((1.0, 3.0), 3.0)


def test_a_load_ends_where_it_is_told_or_earlier():
    load = TipForce(force_N=1.0)
    assert load.until(3.0).history.end_s == 3.0
    assert load.until(3.0).until(4.0) == load.until(3.0)
    bump = OneMinusCosine(start_s=1.0, duration_s=0.5)
    several = SeveralLoads(loads=(load, TipMoment(moment_N_m=1.0, history=bump)))
    assert (several.start_s, load_ends_s(several)) == (0.0, np.inf)
    assert load_ends_s(several.until(2.0)) == 2.0
    assert load_breakpoints(several.until(2.0)) == {0.0, 1.0, 1.5, 2.0}


@pytest.mark.parametrize(("low", "high"), [(-0.1, 0.5), (0.0, 1.01), (0.5, 0.5)])
def test_a_load_outside_the_span_is_refused(low, high):
    with pytest.raises(ValueError, match=r"does not lie within the span|greater than or equal to 0"):
        load_forces(CANTILEVER, DistributedForce(along_z=Spread(force_N_m=3.0), from_m=low, to_m=high))


def test_a_load_acts_from_its_start_until_just_before_its_end():
    basis = basis_of(CANTILEVER, 1)
    free = reduced_order(basis, "hamiltonian", "compiled")
    x = np.array([0.1, 0.2])
    for load, shape in (
        (uniform_force(0.0, 0.0, 1.0, history=Constant(start_s=1.0, end_s=2.0)), lambda t: 1.0),
        (TipForce(force_N=1.0, history=Power(exponent=2, start_s=1.0, end_s=2.0)), lambda t: t * t),
    ):
        for kind in ("numpy", "compiled"):
            model = loaded(free, basis, load, kind)
            assert model.breakpoints == (1.0, 2.0)
            times = (0.0, 0.999, 1.0, 1.5, 1.999, 2.0, 3.0)
            forces = {t: model.derivative(t, x)[1] - free.derivative(t, x)[1] for t in times}
            unit = forces[1.5] / shape(1.5)
            assert abs(unit) > 0.1
            for t, force in forces.items():
                expected = shape(t) * unit if 1.0 <= t < 2.0 else 0.0
                assert force == pytest.approx(expected, abs=1e-9 * abs(unit))


@pytest.mark.parametrize("end", [0.0937, 0.2])
def test_integrators_keep_their_order_across_the_end_of_a_load(end):
    basis = basis_of(CANTILEVER, 1, "unit")
    load = uniform_force(0.0, 0.0, 20.0, history=Constant(end_s=end))
    model = loaded(reduced_order(basis, "hamiltonian", "compiled"), basis, load, "compiled")
    times = np.linspace(0.0, 0.2, 3)
    steps = np.array([4e-3, 2e-3, 1e-3])

    def run(step):
        return simulate(model, times, np.array([0.1, 0.5]), Integrator(method="rk4", step_s=step)).x[-1]

    errors = [np.abs(run(step) - run(5e-5)).max() for step in steps]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] > 3.7


def test_a_model_keeps_its_energy_and_gets_a_tip():
    basis = basis_of(CANTILEVER, 1)
    free = reduced_order(basis, "hamiltonian", "numpy")
    model = loaded(free, basis, TipForce(force_N=10.0, history=Sine(frequency_rad_s=50.0)), "numpy")
    x = np.array([[0.1, 0.2], [0.0, 0.0]])
    np.testing.assert_array_equal(model.energy(x), free.energy(x))
    np.testing.assert_array_equal(model.tip(x), tip_position(CANTILEVER, x[:, :1] @ basis.modes.T))
    assert model.state_names == free.state_names


@dataclass(frozen=True)
class Linear:
    """Another model in the same coordinates, such as a surrogate."""

    state_names: tuple[str, ...] = ("eta_1", "p_1")
    state_units: tuple[str, ...] = ("rad", "kg m²/s")
    breakpoints: tuple[float, ...] = (0.3,)

    def derivative(self, t, x):
        return np.array([x[1], -x[0]])


def test_any_model_in_the_same_coordinates_can_be_loaded():
    basis = basis_of(CANTILEVER, 1)
    load = TipForce(force_N=10.0, history=Sine(frequency_rad_s=50.0, end_s=1.0))
    model = loaded(Linear(), basis, load, "numpy")
    x = np.array([0.1, 0.2])
    free = reduced_order(basis, "hamiltonian", "numpy")
    force = loaded(free, basis, load, "numpy").derivative(0.1, x) - free.derivative(0.1, x)
    np.testing.assert_allclose(model.derivative(0.1, x), np.add(force, [0.2, -0.1]))
    assert model.breakpoints == (0.0, 0.3, 1.0)
    assert not hasattr(model, "energy")
    assert not isinstance(model, CompiledModel)
    with pytest.raises(TypeError, match="a compiled load needs a compiled model; Linear has no kernel"):
        loaded(Linear(), basis, load, "compiled")


def test_a_model_of_other_coordinates_is_refused():
    with pytest.raises(ValueError, match="the model has 2 states, the structure's coordinates make 20"):
        loaded(Linear(), CANTILEVER, tip_force(0.0, 0.0, 1.0), "numpy")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: TipForce(force_N=float("nan")), "force_N"),
        (lambda: TipForce(force_N=1.0, direction=(0.0, 0.0, 0.0)), "direction"),
        (lambda: TipForce(force_N=1.0, direction=(0.0, 1.0)), "direction"),
        (lambda: DistributedForce(), "at least one"),
        (lambda: Spread(force_N_m=1.0, shape="parabolic"), "shape"),
        (lambda: Spread(force_N_m=float("inf")), "force_N_m"),
        (lambda: Sine(frequency_rad_s=0.0), "frequency_rad_s"),
        (lambda: Power(exponent=0), "exponent"),
        (lambda: Constant(start_s=2.0, end_s=1.0), "end_s: 1 is not allowed; allowed: after start_s: 2"),
        (lambda: TipMoment(moment_N_m=1.0, direction=(0.0, 0.0, 0.0)), "direction"),
        (lambda: DistributedMoment(), "at least one"),
        (lambda: ClampAcceleration(acceleration_m_s2=1.0, direction=(0.0, 0.0, 0.0)), "direction"),
        (lambda: SeveralLoads(loads=()), "loads"),
        (lambda: Table(), "file, times_s: one of the two is needed"),
        (lambda: Table(times_s=(0.0, 1.0), factors=(1.0,)), "1 for 2 times"),
        (lambda: Table(times_s=(1.0, 1.0), factors=(1.0, 2.0)), "increasing"),
        (lambda: Ramp(rise_s=0.0), "rise_s"),
        (lambda: OneMinusCosine(duration_s=-1.0), "duration_s"),
    ],
)
def test_loads_that_make_no_sense_are_refused(make, message):
    with pytest.raises(ValidationError, match=message):
        make()


@given(structures(), st.sampled_from(SUBSETS), SEEDS)
def test_a_force_is_felt_along_the_axes_that_the_structure_names(structure, joints, seed):
    """Elsewhere the generalised force is zero in every shape."""
    structure = change(structure, joints=joints, elements=3, gravity_m_s2=0.0)
    q = coordinates(structure, seed)
    free = full_order(structure, "hamiltonian", "numpy")
    x = np.concatenate([q, 0.0 * q])
    for axis in structure.clamp_axes:
        under = loaded(free, structure, tip_force(*axis), "numpy").derivative(1.0, x)
        felt = np.abs(under - free.derivative(1.0, x)).max() > 1e-12
        assert felt == (axis in structure.felt_axes)


def test_a_planar_chain_only_feels_forces_in_its_plane():
    structure = change(CANTILEVER, joints=("in_plane",), bending_stiffness_in_plane_N_m2=50.0)
    basis = basis_of(structure, 1)
    free = reduced_order(basis, "hamiltonian", "compiled")
    model = loaded(free, basis, tip_force(0.0, 0.0, 5.0), "compiled")
    x = np.array([0.1, 0.0])
    np.testing.assert_array_equal(model.derivative(0.0, x), free.derivative(0.0, x))


@given(structures(), st.sampled_from(SUBSETS), SEEDS, st.booleans())
def test_a_moment_is_felt_about_the_axes_that_the_check_names(structure, joints, seed, follows):
    structure = change(structure, joints=joints, elements=3, gravity_m_s2=0.0)
    q = coordinates(structure, seed)
    for axis in np.eye(3) if follows else structure.clamp_axes:
        load = TipMoment(moment_N_m=1.0, direction=tuple(axis), follows=follows)
        felt = np.abs(force_at(structure, q, load_parts(structure, load)[0])).max() > 1e-12
        if felt:
            load.check(structure)
        else:
            with pytest.raises(ValueError, match="no joint feels it"):
                load.check(structure)
