"""The Jacobians that kernels bring are those of their fields."""

from dataclasses import replace

import numpy as np
import pytest
from numba import njit
from random_surrogates import HAMILTONIANS, NETWORKS, PORT_HAMILTONIANS, network, port_polynomial

from flexsurr.evaluation.operations import in_python
from flexsurr.simulation import jacobian
from flexsurr.surrogates import FeatureScaling, compiled

BY_FEATURE = FeatureScaling(
    x=(0.5, 0.3, 2.0, 5.0),
    dx=(3.0, 2.0, 40.0, 9.0),
    x_from=(0.1, 0.2, 0.3, 0.4),
    dx_from=(1.0, 2.0, 3.0, 4.0),
)
SMALL = {f"small {name}": network(form, 2, (5,), "half_log") for name, form in NETWORKS.items()}
DEEP = {name: network(form, 4, (3, 6, 2), "softplus") for name, form in NETWORKS.items()}
BY_DIFFERENCES = ("sparse", "mirrored")
"""Masses of many modes, made for undamped motion: their kernels leave the Jacobian to finite differences."""

SURROGATES = {
    **{name: form for name, form in PORT_HAMILTONIANS.items() if name not in BY_DIFFERENCES},
    "degree 6": port_polynomial(6, 6, even=True),
    **HAMILTONIANS,
    **SMALL,
    **DEEP,
    **{f"{name} by feature": replace(surrogate, scaling=BY_FEATURE) for name, surrogate in DEEP.items()},
}
COMPILED = ("even", "even network", "polynomial", "even network of three pairs", "dissipative_hnn by feature")


@njit(error_model="numpy")
def evaluate(kernel, x, dx, jac, work):
    return jacobian(kernel, 0.0, x, dx, jac, work)


def state(surrogate):
    scales = surrogate.scaling.states(len(surrogate.state_names))
    return 0.7 * np.random.default_rng(3).uniform(-1.0, 1.0, scales.size) * scales


def found(surrogate, run=evaluate):
    model, x = compiled(surrogate), state(surrogate)
    jac = np.empty((x.size, x.size))
    assert run(model.kernel, x, surrogate.derivative(0.0, x), jac, np.full(model.work_size, np.nan)) == 0
    return jac


def in_the_interpreter(kernel, x, dx, jac, work):
    return in_python(jacobian)(kernel, 0.0, x, dx, jac, work)


@pytest.mark.parametrize("name", COMPILED)
def test_compiled_it_is_the_same(name):
    surrogate = SURROGATES[name]
    np.testing.assert_allclose(found(surrogate), found(surrogate, in_the_interpreter), rtol=1e-9)


@pytest.mark.parametrize("surrogate", SURROGATES.values(), ids=SURROGATES.keys())
def test_it_is_what_differences_come_to(surrogate):
    """Run by Python, for to compile each takes seconds."""
    x, count = state(surrogate), len(surrogate.state_names)
    states, rates = surrogate.scaling.states(count), surrogate.scaling.rates(count)
    steps = 1e-5 * np.diag(states)
    ahead, behind = surrogate.derivative(0.0, x + steps), surrogate.derivative(0.0, x - steps)
    expected = (ahead - behind).T / 2e-5 / rates[:, None]
    assert found(surrogate, in_the_interpreter) * states / rates[:, None] == pytest.approx(
        expected, rel=1e-6, abs=1e-7
    )


def test_hamiltons_equations_have_a_symmetric_one():
    """ẋ = Ω ∇H: Ωᵀ ∂ẋ/∂x is the Hessian of H."""
    r = 2
    omega = np.block([[np.zeros((r, r)), np.eye(r)], [-np.eye(r), np.zeros((r, r))]])
    hessian = omega.T @ found(DEEP["hnn"], in_the_interpreter)
    np.testing.assert_allclose(hessian, hessian.T, rtol=1e-12)
