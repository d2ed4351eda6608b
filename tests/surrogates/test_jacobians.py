"""The Jacobians that kernels bring are those of their fields, and no architecture lacks one."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from random_surrogates import (
    HAMILTONIANS,
    NETWORKS,
    PORT_HAMILTONIANS,
    even_network,
    mirrored_network,
    network,
    polynomial,
    port_network,
    port_polynomial,
    sparse_polynomial,
)

import flexsurr
from flexsurr.config.history import Constant, Sine
from flexsurr.config.study import Integrator
from flexsurr.evaluation.operations import in_python
from flexsurr.simulation import jacobian, rhs, simulate
from flexsurr.surrogates import (
    HNN,
    MLP,
    DissipativeHNN,
    FeatureScaling,
    Intervals,
    LearnedLoad,
    NetworkMap,
    PolynomialMap,
    Surrogate,
    compiled,
)
from flexsurr.surrogates.forces import RecordedForces
from flexsurr.surrogates.monomials import monomials_to_degree
from flexsurr.surrogates.potential import Potential

BY_FEATURE = FeatureScaling(
    x=(0.5, 0.3, 2.0, 5.0),
    dx=(3.0, 2.0, 40.0, 9.0),
    x_from=(0.1, 0.2, 0.3, 0.4),
    dx_from=(1.0, 2.0, 3.0, 4.0),
)
SMALL = {f"small {name}": network(form, 2, (5,), "half_log") for name, form in NETWORKS.items()}
DEEP = {name: network(form, 4, (3, 6, 2), "softplus") for name, form in NETWORKS.items()}


def with_potential(surrogate, seed=0):
    """Beside a potential of degree 4."""
    exponents = monomials_to_degree(surrogate.pairs, 4)
    coefficients = np.random.default_rng(seed).normal(size=len(exponents))
    return replace(surrogate, potential=Potential(exponents, coefficients))


SURROGATES = {
    **PORT_HAMILTONIANS,
    "degree 6": port_polynomial(6, 6, even=True),
    "sparse with potential": with_potential(sparse_polynomial()),
    "mirrored with potential": with_potential(mirrored_network(3, "atan")),
    **HAMILTONIANS,
    **SMALL,
    **DEEP,
    **{f"{name} by feature": replace(surrogate, scaling=BY_FEATURE) for name, surrogate in DEEP.items()},
}
COMPILED = (
    "even", "sparse", "mirrored", "sparse with potential", "even network", "polynomial",
    "even network of three pairs", "dissipative_hnn by feature",
)  # fmt: skip
RANDOM = {
    "polynomial of M": lambda seed: port_polynomial(6, 3, even=False, seed=seed),
    "sparse": sparse_polynomial,
    "network of the factor": lambda seed: port_network(6, 5, "softplus", seed),
    "network of entries": lambda seed: port_network(6, 5, "softplus", seed, even=True, factored=False),
    "mirrored": lambda seed: mirrored_network(4, "squareplus", seed),
    "with potential": lambda seed: with_potential(sparse_polynomial(seed), seed),
    "polynomial of H": lambda seed: polynomial(4, 4, seed=seed),
    "even HNN": lambda seed: even_network(4, 5, "atan", seed),
    "HNN": lambda seed: network(HNN, 4, (6,), "tanh", seed),
    "D-HNN": lambda seed: network(DissipativeHNN, 4, (4, 3), "silu", seed),
    "MLP": lambda seed: network(MLP, 4, (5, 3), "tanh", seed),
}

NONE_OF_THEIR_OWN = {
    # the aircraft
    "FlexibleAircraft": "flights are not stiff, and stepped explicitly",
    # reduced models of the beam, and loads along its kinematics
    **dict.fromkeys(
        ("PlanarMode", "PlanarChain", "SpatialChain", "RigidChain"),
        "second derivatives of the kinematics cost more than the evaluations they save",
    ),
    **dict.fromkeys(
        ("PlanarLoaded", "SpatialLoaded", "RigidLoaded", "ClampTurned"),
        "second derivatives of the kinematics cost more than the evaluations they save",
    ),
    "Turns": "intrinsic variables are there to be compared with, at a fixed step",
    # what is not known
    "Program": "any torch module, whose operations come without derivatives",
    "PythonKernel": "equations in Python",
    # what implicit integrators do not take
    "Block": "trajectories side by side are stepped explicitly",
    **dict.fromkeys(("Planar", "PendulumVariation"), "problems that tests solve"),
}
"""Kernels whose Jacobian is left to finite differences, and why."""


@njit(error_model="numpy")
def evaluate(kernel, x, dx, jac, work):
    return jacobian(kernel, 0.0, x, dx, jac, work)


def in_the_interpreter(kernel, x, dx, jac, work):
    return in_python(jacobian)(kernel, 0.0, x, dx, jac, work)


def state(surrogate, seed=3):
    scales = surrogate.scaling.states(len(surrogate.state_names))
    return 0.7 * np.random.default_rng(seed).uniform(-1.0, 1.0, scales.size) * scales


def analytic(model, rates, x, run):
    """∂ẋ/∂x of a compiled model with the rates ẋ, without an evaluation of them, in a workspace of NaN."""
    jac = np.empty((x.size, x.size))
    assert run(model.kernel, x, rates, jac, np.full(model.work_size, np.nan)) == 0
    return jac


def found(surrogate, run=evaluate, seed=3):
    x = state(surrogate, seed)
    return analytic(compiled(surrogate), surrogate.derivative(0.0, x), x, run)


def in_scaled_states(surrogate, jac):
    count = len(surrogate.state_names)
    return jac * surrogate.scaling.states(count) / surrogate.scaling.rates(count)[:, None]


def differences(surrogate, rates_at, x, step=1e-5):
    """The Jacobian in scaled states and rates, by central differences of `rates_at` of states (d, d)."""
    count = x.size
    steps = step * np.diag(surrogate.scaling.states(count))
    return (rates_at(x + steps) - rates_at(x - steps)).T / (
        2 * step * surrogate.scaling.rates(count)[:, None]
    )


@pytest.mark.parametrize("name", COMPILED)
def test_compiled_it_is_the_same(name):
    surrogate = SURROGATES[name]
    np.testing.assert_allclose(found(surrogate), found(surrogate, in_the_interpreter), rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("surrogate", SURROGATES.values(), ids=SURROGATES.keys())
def test_it_is_what_differences_come_to(surrogate):
    """Run by Python, for to compile each takes seconds."""
    expected = differences(surrogate, lambda x: surrogate.derivative(0.0, x), state(surrogate))
    own = in_scaled_states(surrogate, found(surrogate, in_the_interpreter))
    assert own == pytest.approx(expected, rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("kind", RANDOM)
@given(seed=st.integers(0, 2**20))
@settings(max_examples=10)
def test_so_it_is_for_any_parameters_and_states(kind, seed):
    surrogate = RANDOM[kind](seed)
    x = state(surrogate, seed)
    expected = differences(surrogate, lambda x: surrogate.derivative(0.0, x), x)
    own = in_scaled_states(surrogate, found(surrogate, in_the_interpreter, seed))
    np.testing.assert_allclose(own, expected, atol=1e-6 * max(1.0, np.abs(expected).max()))


def recorded_forces(surrogate):
    """Forces recorded before and after time 0."""
    u = np.outer([0.3, 2.0], surrogate.scaling.rates(6)[3:])
    return RecordedForces(compiled(surrogate), np.array([-1.0, 1.0]), u)


def learned_loads(surrogate, kind):
    """Two learned loads, of which one acts at time 0."""
    generator = np.random.default_rng(1)
    q, largest = surrogate.scaling.states(6)[:3], np.tile(surrogate.scaling.rates(6)[3:], 2)
    eta = Intervals(("eta_1", "eta_2", "eta_3"), -q, 1.1 * q)
    names = tuple(f"Q{k + 1}" for k in range(6))
    if kind == "network":
        parameters = generator.normal(size=(3 + 2 + 1) * 5 + (5 + 1) * 6)
        products = ((1, 0), (2, 2))
        forces = NetworkMap(eta, Intervals(names, -largest, largest), 5, "atan", parameters, products)
    else:
        exponents = np.concatenate([np.zeros((1, 3), dtype=np.int64), monomials_to_degree(3, 3)])
        coefficients = generator.normal(size=(len(exponents), 6)) * largest
        forces = PolynomialMap(eta, names, exponents, coefficients)
    late = Sine(start_s=0.5, end_s=1.0, frequency_rad_s=3.0)
    return LearnedLoad(compiled(surrogate), forces, (Constant(), late))


FORCED = {
    "recorded": recorded_forces,
    "polynomial load": lambda surrogate: learned_loads(surrogate, "polynomial"),
    "network load": lambda surrogate: learned_loads(surrogate, "network"),
}


@pytest.mark.parametrize("kind", FORCED)
def test_under_forces_too(kind):
    surrogate = SURROGATES["sparse"]
    model, x = FORCED[kind](surrogate), state(surrogate)

    def rates_at(x):
        return np.array([in_python_rates(model, each) for each in x])

    own = analytic(model, in_python_rates(model, x), x, in_the_interpreter)
    expected = differences(surrogate, rates_at, x)
    assert in_scaled_states(surrogate, own) == pytest.approx(expected, rel=1e-6, abs=1e-7)


def in_python_rates(model, x):
    dx = np.empty_like(x)
    in_python(rhs)(model.kernel, 0.0, x, dx, np.full(model.work_size, np.nan))
    return dx


@pytest.mark.parametrize("name", ["sparse", "mirrored"])
def test_the_stiff_integrator_takes_it(name):
    """Its response is that of an explicit one."""
    surrogate = SURROGATES[name]
    model, x0, t = compiled(surrogate), 0.3 * state(surrogate), np.linspace(0.0, 0.2, 5)
    implicit, explicit = (
        simulate(model, t, x0, Integrator(method=method, rtol=1e-8, atol=1e-10))
        for method in ("radau_iia_5", "dop853")
    )
    assert implicit.completed
    scales = surrogate.scaling.states(6)
    np.testing.assert_allclose(implicit.x / scales, explicit.x / scales, atol=1e-6)


def test_hamiltons_equations_have_a_symmetric_one():
    """ẋ = Ω ∇H: Ωᵀ ∂ẋ/∂x is the Hessian of H."""
    r = 2
    omega = np.block([[np.zeros((r, r)), np.eye(r)], [-np.eye(r), np.zeros((r, r))]])
    hessian = omega.T @ found(DEEP["hnn"], in_the_interpreter)
    np.testing.assert_allclose(hessian, hessian.T, rtol=1e-12)


def test_every_kernel_brings_one_or_says_why_not():
    texts = [path.read_text(encoding="utf-8") for path in Path(flexsurr.__file__).parent.rglob("*.py")]
    of = {
        what: {name for text in texts for name in re.findall(rf"^@{what}\((\w+)", text, re.MULTILINE)}
        for what in ("implements_rhs", "implements_jacobian")
    }
    assert of["implements_rhs"] - of["implements_jacobian"] == NONE_OF_THEIR_OWN.keys()
    assert of["implements_jacobian"] <= of["implements_rhs"]


def test_every_architecture_is_among_those_held_to_differences():
    def below(form):
        return {form}.union(*map(below, form.__subclasses__()))

    own = {form for form in below(Surrogate) if form.__module__.startswith("flexsurr.")}
    concrete = {form for form in own if not form.__abstractmethods__ and form.architecture != "torch"}
    assert {type(surrogate) for surrogate in SURROGATES.values()} == concrete
