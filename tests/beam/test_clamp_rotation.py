"""A clamp that turns: against Pinocchio, the law of energy, rotating beams, and the spin-up of an arm."""

import numpy as np
import pinocchio
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial
from pydantic import ValidationError
from scipy.integrate import solve_ivp
from scipy.linalg import eigvalsh
from structures import ALL_JOINTS, CANTILEVER, FORMS, JOINTS, SEEDS, any_structures, basis_of, change, state
from test_implementations import assert_close
from test_pinocchio import ELEMENTS, ORDER, rigid_body_model

from flexsurr.beam import find_equilibrium, full_order, loaded, natural_modes, reduced_order, tip_position
from flexsurr.beam.chain import chain
from flexsurr.beam.kinematics import configuration, cross, projected_mass, spin_momenta, velocities
from flexsurr.beam.soundness import check_load
from flexsurr.config.history import Constant, OneMinusCosine, Power, Ramp, Sine, SmoothRamp, Table
from flexsurr.config.load import ClampRotation, SeveralLoads, TipForce
from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate
from flexsurr.simulation.history import factor, integral, slope

KINDS = ("described", "numpy", "compiled")
STEP = 1e-30
ARM = (0.3, -0.2, 0.1)
ROTATIONS = st.builds(
    lambda axis, history: ClampRotation(rate_rad_s=3.0, direction=axis, arm_m=ARM, history=history),
    st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda axis: np.linalg.norm(axis) > 0.1),
    st.sampled_from(
        [
            Constant(),
            SmoothRamp(rise_s=2.0),
            Sine(frequency_rad_s=1.7, phase_rad=0.4),
            Power(exponent=2, reference_s=1.5),
            Table(times_s=(0.0, 0.7, 2.0), factors=(0.5, 2.0, 0.0)),
        ]
    ),
)


def turning(structures_):
    """The same structures with the exact inertia, which alone knows a turning clamp."""
    return structures_.map(lambda structure: change(structure, rotary_inertia="exact"))


@settings(max_examples=8)
@given(turning(any_structures(joints=JOINTS)), ROTATIONS, SEEDS)
def test_the_three_implementations_agree(structure, rotation, seed):
    push = TipForce(force_N=3.0, direction=(1.0, 1.0, 1.0), follows=True)
    load = SeveralLoads(loads=(push, rotation))
    for system, model in ((structure, full_order), (basis_of(structure), reduced_order)):
        models = [loaded(model(system, "hamiltonian", kind), system, load, kind) for kind in KINDS]
        x = state(system, seed)
        expected = models[0].derivative(1.0, x)
        assert_close(models[1].derivative(1.0, x), expected)
        assert_close(models[2].derivative(1.0, x), expected)


def test_they_agree_where_the_chain_stays_in_a_plane_and_has_lumps_alone():
    rotation = ClampRotation(rate_rad_s=2.0, direction=(0.0, 1.0, 0.2), history=Ramp(rise_s=3.0))
    basis = basis_of(CANTILEVER, 1)
    models = [loaded(reduced_order(basis, "as_printed", kind), basis, rotation, kind) for kind in KINDS]
    x = state(basis, 1)
    for other in models[1:]:
        assert_close(other.derivative(1.0, x), models[0].derivative(1.0, x))


@pytest.mark.parametrize("form", [FORMS[2], FORMS[-2]], ids=["uniform", "bent"])
def test_inertial_forces_are_those_of_a_driven_joint_at_the_root(form):
    """Pinocchio's inverse dynamics with a revolute joint at the clamp, less that without: gravity turns."""
    structure = change(ALL_JOINTS, **form, elements=ELEMENTS)
    axis = np.array([0.2, -0.5, 0.8])
    swing = Sine(frequency_rad_s=1.3, phase_rad=0.2)
    rotation = ClampRotation(rate_rad_s=4.0, direction=tuple(axis), arm_m=ARM, history=swing)
    free = full_order(structure, "hamiltonian", "numpy")
    x = state(structure, 3)
    t, half = 0.9, len(x) // 2
    felt = loaded(free, structure, rotation, "numpy").derivative(t, x) - free.derivative(t, x)

    still = rigid_body_model(structure)
    driven = pinocchio.Model()
    joint = pinocchio.JointModelRevoluteUnaligned(axis / np.linalg.norm(axis))
    driven.addJoint(0, joint, pinocchio.SE3.Identity(), "clamp")
    frame = driven.addFrame(
        pinocchio.Frame("arm", 1, 0, pinocchio.SE3(np.eye(3), np.array(ARM)), pinocchio.FrameType.OP_FRAME)
    )
    driven = pinocchio.appendModel(driven, still, frame, pinocchio.SE3.Identity())
    driven.gravity.linear = still.gravity.linear

    motion = x[:half][ORDER], free.derivative(t, x)[:half][ORDER], np.zeros(half)
    clamp = [4.0 * of(swing, t) for of in (integral, factor, slope)]
    both = (np.concatenate([[first], rest]) for first, rest in zip(clamp, motion, strict=True))
    moving = np.array(pinocchio.rnea(driven, driven.createData(), *both))
    at_rest = np.array(pinocchio.rnea(still, still.createData(), *motion))
    expected = at_rest - moving[1:]
    np.testing.assert_allclose(felt[half:][ORDER], expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())


@settings(max_examples=20)
@given(turning(any_structures(gravity_m_s2=0.0)), ROTATIONS, SEEDS)
def test_the_energy_in_space_grows_by_the_work_of_the_clamp(structure, rotation, seed):
    """dE/dt = ω · dL/dt − q̇ᵀ C q̇ with E and L as seen from space, L about the axis; by a complex step."""
    beam, t = chain(structure), 0.9
    model = loaded(full_order(structure, "hamiltonian", "numpy"), structure, rotation, "numpy")
    x = state(structure, seed)
    dx = model.derivative(t, x)
    axis = 3.0 * np.array(rotation.direction) / np.linalg.norm(rotation.direction)
    omega = (factor(rotation.history, t) + 1j * STEP * slope(rotation.history, t)) * axis
    energy, momentum = in_space(beam, x + 1j * STEP * dx, omega)
    half = len(x) // 2
    work = omega.real @ momentum.imag / STEP - beam.damping @ dx[:half] ** 2
    size = np.abs(energy.real) + np.abs(momentum.real @ omega.real)
    assert energy.imag / STEP == pytest.approx(work, rel=1e-9, abs=1e-9 * size)


def in_space(beam, x, omega):
    """Energy, without gravity, and angular momentum (3,) about the axis at (q, p) (2n,), seen from space."""
    half = len(x) // 2
    q, p = x[:half], x[half:]
    at = configuration(beam, q)
    rates = np.linalg.solve(projected_mass(beam, at, np.eye(half)), p)
    motion = velocities(beam, at, rates[None]).combined(np.ones(1))
    places = at.masses + np.array(ARM)
    seen, spins = motion.masses + cross(omega, places), motion.turning + omega
    pushes = beam.masses[:, None] * seen
    momenta = cross(places, pushes)
    energy = 0.5 * np.sum(pushes * seen) + 0.5 * beam.stiffness @ q**2
    if beam.tensors is not None:
        own = spin_momenta(beam, at, spins[None])[0]
        momenta, energy = momenta + own, energy + 0.5 * np.sum(own * spins)
    return energy, momenta.sum(axis=0)


def test_after_a_quarter_turn_gravity_pulls_from_aside():
    """A clamp that has turned by 90° and stopped is the clamp of a structure that hangs down."""
    upright = change(
        ALL_JOINTS, rotary_inertia="exact", clamp_psi_deg=0.0, clamp_theta_deg=0.0, clamp_phi_deg=0.0
    )
    hanging = change(upright, clamp_theta_deg=-90.0)
    rotation = ClampRotation(
        rate_rad_s=0.5 * np.pi, direction=(0.0, 1.0, 0.0), history=OneMinusCosine(duration_s=2.0)
    )
    x = state(upright, 5)
    for kind in ("described", "numpy"):
        turned = loaded(full_order(upright, "hamiltonian", kind), upright, rotation, kind)
        expected = full_order(hanging, "hamiltonian", kind).derivative(0.0, x)
        assert_close(turned.derivative(2.5, x), expected)


def blade(hub=0.0, shapes=9):
    """Bending, tension at unit speed, mass (k, k) and ∫ (a + x) w (k,) of a uniform beam of unit EI, m and L.

    Of Southwell's equation EI w⁗ − (T w′)′ = m ω² w, T = ½ m Ω² ((a + L)² − (a + x)²) with a hub a, by
    Ritz' method with polynomials, whose integrals are exact.
    """
    place = Polynomial([hub, 1.0])
    tension = 0.5 * ((hub + 1.0) ** 2 - place**2)
    powers = [Polynomial([0.0, 1.0]) ** (k + 2) for k in range(shapes)]

    def over_span(integrand):
        return integrand.integ()(1.0)

    bending, stiffening, mass = (
        np.array([[over_span(of(a, b)) for a in powers] for b in powers])
        for of in (
            lambda a, b: a.deriv(2) * b.deriv(2),
            lambda a, b: tension * a.deriv() * b.deriv(),
            lambda a, b: a * b,
        )
    )
    return bending, stiffening, mass, np.array([over_span(place * shape) for shape in powers])


@pytest.mark.parametrize(("speed", "hub"), [(0.0, 0.0), (1.0, 0.0), (4.0, 0.0), (4.0, 0.5), (12.0, 0.0)])
def test_rotation_stiffens_a_blade(speed, hub):
    """Frequencies across the plane of rotation, against Southwell's equation."""
    structure, unit = change(CANTILEVER, elements=32), np.sqrt(50.0 / 0.2)
    rotation = ClampRotation(rate_rad_s=speed * unit, arm_m=(hub, 0.0, 0.0))
    omega, _ = natural_modes(structure, find_equilibrium(structure, rotation), rotation)
    bending, stiffening, mass, _ = blade(hub)
    expected = np.sqrt(eigvalsh(bending + speed**2 * stiffening, mass)[:3])
    np.testing.assert_allclose(omega[:3] / unit, expected, rtol=3e-3)


def test_in_the_plane_of_rotation_the_square_is_less_by_that_of_the_speed():
    """ω² of lagging is that of flapping less Ω²: to rounding of the chain, too."""
    rotation = ClampRotation(rate_rad_s=40.0, arm_m=(0.2, 0.0, 0.0))
    lagging = change(
        CANTILEVER,
        joints=("in_plane",),
        bending_stiffness_in_plane_N_m2=50.0,
        bending_stiffness_out_of_plane_N_m2=None,
    )
    flap, lag = (natural_modes(blade, np.zeros(10), rotation)[0] for blade in (CANTILEVER, lagging))
    np.testing.assert_allclose(lag**2, flap**2 - 40.0**2, rtol=1e-9)


def arm(elements, *joints):
    """The arm of Simo and Vu-Quoc (1986): L 10, EI 1.4e4, EA 2.8e7, ρA 1.2; without its rotary inertia."""
    return change(
        CANTILEVER,
        name="arm",
        length_m=10.0,
        elements=elements,
        joints=joints,
        mass_per_length_kg_m=1.2,
        bending_stiffness_out_of_plane_N_m2=None,
        bending_stiffness_in_plane_N_m2=1.4e4,
        axial_stiffness_N=2.8e7,
    )


def test_a_turning_arm_stretches_as_the_continuous_one():
    """EA u'' + ρA Ω² (x + u) = 0: the tip moves out by tan(kL)/k − L = 5.143e-4, k² = ρA Ω²/EA."""
    k = 6.0 * np.sqrt(1.2 / 2.8e7)
    expected = np.tan(10.0 * k) / k - 10.0
    assert expected == pytest.approx(5.143e-4, rel=1e-3)
    turned = ClampRotation(rate_rad_s=6.0)
    errors = []
    for elements in (10, 20):
        structure = arm(elements, "in_plane", "axial")
        tip = tip_position(structure, find_equilibrium(structure, turned))
        errors.append(abs(tip[0] - 10.0 - expected))
    assert errors[0] < 0.01 * expected
    assert errors[1] < 0.3 * errors[0]


def test_the_spin_up_of_the_arm():
    """To 6 rad/s within 15 s: the tip lags by 0.6 m, as in Southwell's equation in the plane of rotation.

    m v̈ + EI v⁗ − (T v′)′ − m Ω² v = −m Ω̇ x is of first order in v: within v²/L² of the arm.
    """
    basis, history = basis_of(arm(10, "in_plane"), 2), SmoothRamp(rise_s=15.0)
    spin_up = ClampRotation(rate_rad_s=6.0, history=history)
    model = loaded(reduced_order(basis, "hamiltonian", "numpy"), basis, spin_up, "numpy")
    t = np.linspace(0.0, 17.0, 171)
    integrator = Integrator(method="scipy_dop853", rtol=1e-5, atol=1e-7)
    aside = model.tip(simulate(model, t, np.zeros(4), integrator).x)[:, 1]

    bending, stiffening, mass, outwards = blade(shapes=4)
    springs, forces = (np.linalg.solve(mass, part) for part in (1.4e4 / 1.2e4 * bending, 10.0 * outwards))
    turning = np.linalg.solve(mass, stiffening) - np.eye(4)

    def rate(at, y):
        speed, growth = (6.0 * of(history, at) for of in (factor, slope))
        return np.concatenate([y[4:], -(springs + speed**2 * turning) @ y[:4] - growth * forces])

    linear = solve_ivp(rate, (0.0, 17.0), np.zeros(8), "DOP853", t, rtol=1e-7, atol=1e-9).y[:4].sum(axis=0)
    assert -0.62 < aside.min() < -0.55
    np.testing.assert_allclose(aside, linear, atol=0.01 * np.abs(linear).max())
    assert np.abs(aside[t > 15.0]).max() < 0.02 * np.abs(aside).max()


@pytest.mark.parametrize(
    "history",
    [
        Constant(start_s=1.0),
        Constant(end_s=2.0),
        SmoothRamp(rise_s=2.0, end_s=1.0),
        Sine(frequency_rad_s=2.0, start_s=0.5),
        Table(times_s=(0.5, 1.0), factors=(0.0, 1.0)),
        OneMinusCosine(duration_s=2.0, end_s=1.0),
    ],
)
def test_a_clamp_that_would_turn_at_once_is_refused(history):
    with pytest.raises(
        ValueError, match=r"clamp_rotation: history: the clamp's rate jumps at \S+ s; allowed"
    ):
        check_load(CANTILEVER, ClampRotation(rate_rad_s=1.0, history=history))


def test_what_a_turning_clamp_does_not_go_with_is_refused():
    rotation = ClampRotation(rate_rad_s=1.0)
    with pytest.raises(ValueError, match=r"rotary_inertia is constant.*allowed: exact"):
        check_load(ALL_JOINTS, rotation)
    with pytest.raises(ValidationError, match="2 of kind clamp_rotation; allowed: one at most"):
        SeveralLoads(loads=(rotation, rotation))
    with pytest.raises(ValueError, match="no joint feels it"):
        ClampRotation(rate_rad_s=0.0).check(CANTILEVER)
    with pytest.raises(ValueError, match="the clamp's rate changes: it has no static equilibrium"):
        find_equilibrium(CANTILEVER, ClampRotation(rate_rad_s=1.0, history=Ramp(rise_s=1.0)))
    heavy = change(CANTILEVER, gravity_m_s2=9.81)
    with pytest.raises(ValueError, match="gravity turns, seen from the clamp: it has no static equilibrium"):
        find_equilibrium(heavy, ClampRotation(rate_rad_s=1.0, direction=(0.0, 1.0, 0.0)))
    bent = change(ALL_JOINTS, rotary_inertia="exact", gravity_m_s2=0.0)
    with pytest.raises(ValueError, match="Coriolis forces of a turning clamp couple its motions"):
        natural_modes(bent, find_equilibrium(bent, rotation), rotation)


def test_a_forced_response_leaves_the_clamp_turning():
    rotation = ClampRotation(rate_rad_s=1.0)
    assert rotation.until(3.0) is rotation


def test_a_surrogate_feels_it_by_its_own_rates():
    """Any model in the structure's coordinates turns: what it feels follows from η and its own η̇ alone."""
    basis = basis_of(CANTILEVER, 2)
    exact = reduced_order(basis, "hamiltonian", "numpy")
    rotation = ClampRotation(rate_rad_s=5.0, direction=(0.0, 1.0, 0.0), history=SmoothRamp(rise_s=2.0))

    class Halved:
        """A surrogate whose rates are half of what the structure's are."""

        state_names, state_units, breakpoints = exact.state_names, exact.state_units, ()

        def derivative(self, t, x):
            return 0.5 * exact.derivative(t, x)

    x = state(basis, 2)
    slower = np.concatenate([x[:2], 0.5 * x[2:]])
    felt = loaded(Halved(), basis, rotation, "numpy").derivative(0.7, x) - Halved().derivative(0.7, x)
    expected = loaded(exact, basis, rotation, "numpy").derivative(0.7, slower) - exact.derivative(0.7, slower)
    np.testing.assert_allclose(felt, expected, rtol=1e-10, atol=1e-12)
