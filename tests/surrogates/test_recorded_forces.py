"""Forces between their samples: straight lines, compiled as in Python."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_surrogates import network

from flexsurr.simulation.rhs import evaluate
from flexsurr.surrogates import HNN, compiled
from flexsurr.surrogates.forces import RecordedForces

GENERATOR = np.random.default_rng(0)
T = np.cumsum(GENERATOR.uniform(0.1, 1.0, size=7))
U = GENERATOR.normal(size=(7, 2))
MODEL = compiled(network(HNN, 4, (5,), "tanh"))
FORCED = RecordedForces(MODEL, T, U)
STATE = np.array([0.3, -0.2, 1.0, 0.5])


@given(t=st.floats(T[0] - 1.0, T[-1] + 1.0))
def test_momenta_feel_the_force_between_samples_and_nothing_else_changes(t):
    added = FORCED.derivative(t, STATE) - MODEL.derivative(t, STATE)
    expected = [np.interp(t, T, force) for force in U.T]
    np.testing.assert_allclose(added, [0.0, 0.0, *expected], atol=1e-12)


@given(t=st.floats(T[0] - 1.0, T[-1] + 1.0))
def test_the_kernel_is_the_model_in_python(t):
    dx = np.empty(4)
    evaluate(FORCED.kernel, t, STATE, dx, np.empty(FORCED.work_size))
    np.testing.assert_allclose(dx, FORCED.derivative(t, STATE), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("u", [U[:, :1], U[1:], U[0]])
def test_forces_that_do_not_fit_are_refused(u):
    with pytest.raises(ValueError, match="forces of shape"):
        RecordedForces(MODEL, T, u)
