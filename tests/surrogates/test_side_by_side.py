"""Trajectories side by side: each as it is alone, whatever its neighbours are."""

import tracemalloc

import numpy as np
import pytest
from random_surrogates import SCALING, even_network, network, polynomial

from flexsurr.config.study import Integrator
from flexsurr.simulation import evaluate, simulate, simulate_ensemble
from flexsurr.simulation.dimension import LANES
from flexsurr.simulation.side_by_side import Block, aligned
from flexsurr.surrogates import HNN, MLP, compiled

EVEN = polynomial(2, 8, "even")
FORMS = {
    "polynomial of few terms": polynomial(2, 6, "even"),
    "polynomial, an even number of terms": EVEN,
    "an odd number": polynomial(2, 10, "even"),
    "a pair in the loop, even": polynomial(2, 12, "even"),
    "a pair in the loop, odd": polynomial(2, 14, "even"),
    "few odd powers": polynomial(2, 3, "mechanical"),
    "odd powers": polynomial(2, 7, "mechanical"),
    "hnn, quotients in pairs": network(HNN, 2, (7,), "half_log"),
    "hnn, others": network(HNN, 2, (8,), "softplus"),
    "even hnn": even_network(2, 5, "atan"),
    "mlp": network(MLP, 2, (5,), "tanh"),
}
STEP = Integrator(method="rk4", step_s=0.002)
T = np.array([0.0, 0.005, 0.02])


def states(number, reach=1.0):
    return np.random.default_rng(1).uniform(-reach, reach, (number, 2)) * SCALING.states(2)


@pytest.mark.parametrize("surrogate", FORMS.values(), ids=FORMS)
def test_the_equations_of_a_block_are_those_of_each(surrogate):
    model, x = compiled(surrogate), states(LANES)
    dx = np.empty(2 * LANES)
    evaluate(Block(model.kernel), 0.0, x.T.ravel(), dx, np.full(4 * LANES, np.nan))
    expected = surrogate.derivative(0.0, x)
    assert np.all(np.abs(dx.reshape(2, -1).T - expected) <= 1e-12 * np.abs(expected).max(axis=0))


def test_what_is_aligned_begins_a_line_of_the_cache():
    kept = [aligned(n) for n in (1, 7, 2 * LANES, 2 * LANES + 3)]
    assert [len(each) for each in kept] == [1, 7, 2 * LANES, 2 * LANES + 3]
    assert {each.ctypes.data % 64 for each in kept} == {0}


def test_each_is_the_trajectory_of_a_single_call():
    model, x0 = compiled(EVEN), states(150)
    found = simulate_ensemble(model, T, x0, STEP)
    each = [simulate(model, T, start, STEP) for start in x0]
    np.testing.assert_allclose(found.kept, [one.x for one in each], rtol=1e-10, atol=1e-12)
    assert found.evaluations == sum(one.evaluations for one in each)


def test_neither_threads_nor_neighbours_change_a_bit():
    model, x0 = compiled(EVEN), states(3 * LANES + 5)
    one = simulate_ensemble(model, T, x0, STEP, threads=1).kept
    np.testing.assert_array_equal(simulate_ensemble(model, T, x0, STEP, threads=3).kept, one)
    order = np.random.default_rng(2).permutation(len(x0))
    np.testing.assert_array_equal(simulate_ensemble(model, T, x0[order], STEP).kept, one[order])


def test_one_that_leaves_the_finite_numbers_ends_alone():
    model, x0 = compiled(EVEN), states(LANES)
    alone = simulate_ensemble(model, T, x0, STEP).kept
    lost = x0.copy()
    lost[9] = [1e60, 0.0]
    found = simulate_ensemble(model, T, lost, STEP)
    assert np.flatnonzero(~found.completed).tolist() == [9]
    assert found.end_time_s[9] == 0.0
    assert "left the finite numbers" in found.reasons[9]
    np.testing.assert_array_equal(found.kept[9, 0], lost[9])
    assert np.isnan(found.kept[9, 1:]).all()
    others = np.arange(LANES) != 9
    np.testing.assert_array_equal(found.kept[others], alone[others])


def test_memory_is_that_of_a_block():
    model, x0, t = compiled(EVEN), states(30 * LANES), np.linspace(0.0, 0.2, 501)
    integrator = Integrator(method="rk4", step_s=0.01)

    def ends(numbers, x):
        return x[:, -1]

    simulate_ensemble(model, t[:2], x0[:LANES], integrator, observe=ends)
    tracemalloc.start()
    found = simulate_ensemble(model, t, x0, integrator, observe=ends, threads=1)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found.kept.shape == (len(x0), 2)
    assert peak < 5 * LANES * t.size * 2 * 8
