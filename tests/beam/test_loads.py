from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.integrate import quad, solve_bvp
from structures import (
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
    reduced_order,
    tip_position,
)
from flexsurr.beam.chain import chain
from flexsurr.beam.kinematics import configuration
from flexsurr.config.load import Constant, DistributedForce, Power, Sine, Spread, TipForce
from flexsurr.config.structure import Structure
from flexsurr.config.study import Integrator
from flexsurr.simulation import CompiledModel, simulate
from flexsurr.simulation.history import breakpoints, factor, history_factor, history_kernel

KINDS = ("described", "numpy", "compiled")
VECTORS = st.tuples(*[st.floats(-20.0, 20.0)] * 3).filter(any)
HISTORIES = st.one_of(
    st.just(Constant()),
    st.floats(0.1, 50.0).map(lambda w: Sine(frequency_rad_s=w, phase_rad=0.3, end_s=2.0)),
    st.integers(1, 4).map(lambda n: Power(exponent=n, reference_s=0.8, start_s=0.5)),
)
LOADS = st.one_of(
    st.builds(lambda v, history: tip_force(*v).model_copy(update={"history": history}), VECTORS, HISTORIES),
    st.builds(lambda v, history: uniform_force(*v, history=history), VECTORS, HISTORIES),
    st.builds(
        lambda v, history, place: DistributedForce(
            along_y=Spread(force_N_m=v[1], shape="one_minus_elliptic"),
            along_z=Spread(force_N_m=v[2], shape="elliptic"),
            from_m=0.1,
            to_m=1.0,
            acts_on=place,
            history=history,
        ),
        VECTORS,
        HISTORIES,
        st.sampled_from(["span", "tip"]),
    ),
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
    x = simulate(model, t, np.zeros(4), Integrator(method="dop853", rtol=1e-11, atol=1e-13)).x
    powers = [
        (model.derivative(now, at)[2:] - free.derivative(now, at)[2:]) @ free.derivative(now, at)[:2]
        for now, at in zip(t, x, strict=True)
    ]
    weights = np.full(t.size, 2.0)
    weights[1::2], weights[[0, -1]] = 4.0, 1.0
    gained = free.energy(x[-1]) - free.energy(x[0])
    assert gained > 1.0
    assert weights @ powers * (t[1] - t[0]) / 3.0 == pytest.approx(gained, rel=1e-6)


@given(HISTORIES, st.floats(0.0, 3.0))
def test_histories_are_the_same_compiled(history, t):
    assert history_factor(history_kernel(history), t) == pytest.approx(
        factor(history, t), rel=1e-13, abs=1e-14
    )


def test_histories_are_what_their_names_say():
    assert factor(Constant(), 7.0) == 1.0
    assert factor(Sine(frequency_rad_s=50.0), 0.02) == pytest.approx(np.sin(1.0))
    assert factor(Power(exponent=2), 3.0) == 9.0
    assert factor(Power(exponent=3, reference_s=2.0), 4.0) == 8.0
    assert breakpoints(Constant(start_s=1.0)) == (1.0,)


def test_a_load_ends_where_it_is_told_or_earlier():
    load = TipForce(force_N=1.0)
    assert load.until(3.0).history.end_s == 3.0
    assert load.until(3.0).until(4.0) == load.until(3.0)


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
        (lambda: Constant(start_s=2.0, end_s=1.0), "must end after its start"),
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
