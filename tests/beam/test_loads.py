from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from structures import CANTILEVER, SEEDS, basis_of, change, coordinates, state, structures
from test_implementations import assert_close

from flexsurr.beam import (
    DeadTipForce,
    DistributedForce,
    SineDistributedLoad,
    SineTipForce,
    element_frames,
    full_order,
    loaded,
    reduced_order,
    tip_position,
)
from flexsurr.beam.chain import chain
from flexsurr.beam.kinematics import configuration
from flexsurr.config.study import Integrator
from flexsurr.simulation import CompiledModel, simulate

KINDS = ("described", "numpy", "compiled")
VECTORS = st.tuples(*[st.floats(-20.0, 20.0)] * 3).filter(any)
LOADS = st.one_of(
    VECTORS.map(DeadTipForce),
    VECTORS.map(lambda v: SineTipForce(10.0, 50.0, v, 0.0, 2.0)),
    VECTORS.map(lambda v: DistributedForce(v, 0.5, 3.0)),
    VECTORS.map(lambda v: SineDistributedLoad(v[0], v[1], 3.0, "elliptic", 0.1, 1.0)),
)


@settings(max_examples=40)
@given(structures(), LOADS, SEEDS)
def test_the_three_implementations_agree(structure, load, seed):
    for system, model in ((structure, full_order), (basis_of(structure), reduced_order)):
        models = [loaded(model(system, "hamiltonian", kind), system, load, kind) for kind in KINDS]
        x = state(system, seed)
        expected = models[0].derivative(1.0, x)
        assert_close(models[1].derivative(1.0, x), expected)
        assert_close(models[2].derivative(1.0, x), expected)


@given(structures(), VECTORS, SEEDS)
def test_loads_do_virtual_work(structure, force, seed):
    """Q is the derivative of the work of the dead forces, here by a complex step."""
    basis = basis_of(structure)
    r = len(basis.omega_rad_s)
    eta = np.random.default_rng(seed).uniform(-0.5, 0.5, r)
    q = (eta + 1e-30j * np.eye(r)) @ basis.modes.T
    at = configuration(chain(structure), q)
    length = chain(structure).element_length
    works = {
        DeadTipForce(force): at.nodes[..., -1, :] @ force,
        DistributedForce(force): length * at.centres.sum(axis=-2) @ force,
    }
    x = np.concatenate([eta, np.zeros(r)])
    for load, work in works.items():
        model = reduced_order(basis, "hamiltonian", "compiled")
        added = loaded(model, basis, load, "compiled").derivative(0.0, x) - model.derivative(0.0, x)
        np.testing.assert_allclose(added[:r], 0.0)
        scale = np.abs(model.derivative(0.0, x)).max() + np.abs(work.imag / 1e-30).max()
        np.testing.assert_allclose(added[r:], work.imag / 1e-30, rtol=0.0, atol=1e-12 * scale)


@given(structures(), st.floats(-20.0, 20.0), SEEDS)
def test_couples_do_virtual_work(structure, couple, seed):
    """Each couple's power is its size times its element's turning about its own x axis (by differences)."""
    x = state(structure, seed)
    n = structure.coordinates
    q, rates = x[:n], coordinates(structure, seed + 1)
    step = 1e-6
    before, at, after = (element_frames(structure, q + s * step * rates) for s in (-1.0, 0.0, 1.0))
    turning = np.swapaxes(at, -1, -2) @ (after - before) / (2.0 * step)
    load = SineDistributedLoad(0.0, couple, 1.0)
    power = load.forces(structure).couples @ turning[:, 2, 1]
    model = full_order(structure, "hamiltonian", "numpy")
    added = loaded(model, structure, load, "numpy").derivative(0.5 * np.pi, x) - model.derivative(
        0.5 * np.pi, x
    )
    assert added[n:] @ rates == pytest.approx(power, abs=1e-7 * (1.0 + abs(couple)))


@pytest.mark.parametrize("shape", ["uniform", "linear", "elliptic"])
def test_elements_receive_the_integral_over_their_own_span(shape):
    structure = change(CANTILEVER, elements=7)
    load = SineDistributedLoad(3.0, 2.0, 1.0, shape, 0.25, 0.9)
    along = {"uniform": lambda x: 1.0, "linear": lambda x: x, "elliptic": lambda x: np.sqrt(1.0 - x * x)}[
        shape
    ]
    forces = load.forces(structure)
    for i in range(7):
        low, high = np.clip([i / 7, (i + 1) / 7], 0.25, 0.9)
        integral = quad(along, low, high)[0]
        np.testing.assert_allclose(forces.on_centres[i], [0.0, 0.0, 3.0 * integral], atol=1e-12)
        assert forces.couples[i] == pytest.approx(2.0 * integral, abs=1e-12)
    assert not forces.on_tip.any()


@pytest.mark.parametrize(("low", "high"), [(-0.1, 0.5), (0.0, 1.01), (0.5, 0.5)])
def test_a_load_outside_the_span_is_refused(low, high):
    load = SineDistributedLoad(3.0, 2.0, 1.0, "uniform", low, high)
    with pytest.raises(ValueError, match="does not lie within the span"):
        load.forces(CANTILEVER)


def test_a_load_acts_from_its_start_until_just_before_its_end():
    basis = basis_of(CANTILEVER, 1)
    free = reduced_order(basis, "hamiltonian", "compiled")
    x = np.array([0.1, 0.2])
    for load, factor in (
        (DistributedForce((0.0, 0.0, 1.0), 1.0, 2.0), lambda t: 1.0),
        (SineTipForce(1.0, 50.0, start_s=1.0, end_s=2.0), lambda t: np.sin(50.0 * t)),
    ):
        for kind in ("numpy", "compiled"):
            model = loaded(free, basis, load, kind)
            assert model.breakpoints == (1.0, 2.0)
            times = (0.0, 0.999, 1.0, 1.5, 1.999, 2.0, 3.0)
            forces = {t: model.derivative(t, x)[1] - free.derivative(t, x)[1] for t in times}
            unit = forces[1.5] / factor(1.5)
            assert abs(unit) > 0.1
            for t, force in forces.items():
                expected = factor(t) * unit if 1.0 <= t < 2.0 else 0.0
                assert force == pytest.approx(expected, abs=1e-9 * abs(unit))


@pytest.mark.parametrize("end", [0.0937, 0.2])
def test_integrators_keep_their_order_across_the_end_of_a_load(end):
    basis = basis_of(CANTILEVER, 1, "unit")
    load = DistributedForce((0.0, 0.0, 20.0), 0.0, end)
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
    model = loaded(free, basis, SineTipForce(10.0, 50.0), "numpy")
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
    load = SineTipForce(10.0, 50.0, end_s=1.0)
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
        loaded(Linear(), CANTILEVER, DeadTipForce((0.0, 0.0, 1.0)), "numpy")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: DeadTipForce((1.0, 2.0)), "force_N"),
        (lambda: DeadTipForce((1.0, 2.0, float("nan"))), "force_N"),
        (lambda: DistributedForce((1.0, float("inf"), 0.0)), "force_N_m"),
        (lambda: SineDistributedLoad(float("inf"), 0.0, 1.0), "force_N_m"),
        (lambda: SineDistributedLoad(1.0, float("nan"), 1.0), "couple_N_m_m"),
        (lambda: SineDistributedLoad(1.0, 1.0, 1.0, "parabolic"), "shape"),
        (lambda: SineTipForce(1.0, 1.0, (0.0, 0.0, 0.0)), "direction"),
        (lambda: SineTipForce(float("nan"), 1.0), "amplitude_N"),
        (lambda: SineTipForce(1.0, -1.0), "frequency_rad_s"),
        (lambda: SineTipForce(1.0, 1.0, start_s=2.0, end_s=1.0), "must end after its start"),
    ],
)
def test_loads_that_make_no_sense_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_a_planar_chain_only_feels_forces_in_its_plane():
    structure = change(CANTILEVER, joints=("in_plane",), bending_stiffness_in_plane_N_m2=50.0)
    basis = basis_of(structure, 1)
    free = reduced_order(basis, "hamiltonian", "compiled")
    model = loaded(free, basis, DeadTipForce((0.0, 0.0, 5.0)), "compiled")
    x = np.array([0.1, 0.0])
    np.testing.assert_array_equal(model.derivative(0.0, x), free.derivative(0.0, x))
