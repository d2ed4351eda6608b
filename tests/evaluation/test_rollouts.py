"""Rollouts of surrogates against recorded trajectories, and the published tasks."""

import numpy as np
import pandas as pd
import pytest

from flexsurr.config.study import Integrator
from flexsurr.evaluation.published_tasks import (
    PENDULUM,
    SPRING,
    TASKS,
    energy_mse,
    grid,
    rate_mse,
    recordings,
)
from flexsurr.evaluation.rollouts import (
    HeldOut,
    HeldOutTrajectories,
    rollout_cost,
    rollout_curves,
    rollout_errors,
    rollout_table,
)
from flexsurr.surrogates import PolynomialHamiltonian, compiled
from flexsurr.surrogates.scaling import Scaling

NAMES, UNITS = ("q", "p"), ("m", "kg m/s")
SMOOTH = Integrator(method="rk4", step_s=0.002)
SQUARES = np.array([[2, 0], [0, 2]])


def oscillator(stiffness: float = 1.0) -> PolynomialHamiltonian:
    """H = p² + stiffness q², whose period is π where the stiffness is 1."""
    return PolynomialHamiltonian(
        np.array([stiffness, 1.0]), Scaling(1.0, 1.0, 1.0), NAMES, UNITS, exponents=SQUARES
    )


def orbit(number: int, radius: float) -> HeldOut:
    t = np.linspace(0.3, 2.3, 41)
    phase = 2.0 * (t - t[0])
    return HeldOut(number, t, radius * np.column_stack([np.cos(phase), -np.sin(phase)]))


@pytest.fixture(scope="module")
def held_out():
    return HeldOutTrajectories((orbit(3, 1.0), orbit(5, 0.5)), np.array([0.5, 0.25]), NAMES, UNITS)


def test_the_exact_model_has_no_error_and_keeps_its_energy(held_out):
    table = rollout_table({"polynomial": oscillator()}, held_out, SMOOTH)
    assert table["trajectory"].tolist() == [3, 5]
    assert table["duration_s"].tolist() == pytest.approx([2.0, 2.0])
    assert table["completed"].all()
    assert table["error_percent"].max() < 1e-7
    assert table["own_energy_drift_percent"].max() < 1e-7


def test_errors_are_in_percent_of_each_states_spread(held_out):
    recorded = held_out.trajectories[0]
    assert held_out.error_percent(recorded, np.add(recorded.x, [0.05, 0.0])) == pytest.approx(
        10.0 / np.sqrt(2.0)
    )
    assert held_out.error_percent(recorded, np.add(recorded.x, [0.05, -0.025])) == pytest.approx(10.0)
    assert held_out.error_percent(recorded, recorded.x[:-1]) == np.inf


def test_a_run_is_judged_by_its_worst_rollout_and_a_diverging_one_is_counted(held_out):
    good, stiffer = (rollout_errors(oscillator(k), held_out, SMOOTH) for k in (1.0, 1.3))
    assert good["long_response_error_percent_worst"] < 1e-7 < stiffer["long_response_error_percent_worst"]
    assert stiffer["long_response_error_percent_median"] < stiffer["long_response_error_percent_worst"]
    assert (good["diverged"], stiffer["diverged"]) == (0, 0)
    lost = rollout_errors(oscillator(-1e8), held_out, SMOOTH)
    assert lost["diverged"] == 2
    assert lost["long_response_error_percent_worst"] is None


def test_recorded_forces_act_on_the_surrogate_too():
    """A spring from rest under a force that grows, ṗ = −2 q + u: straight lines, so the samples are exact."""
    t = np.linspace(0.0, 2.0, 9)
    q, p = 0.5 * t - 0.25 * np.sin(2.0 * t), 0.25 - 0.25 * np.cos(2.0 * t)
    pushed = HeldOut(0, t, np.column_stack([q, p]), t[:, None])
    held_out = HeldOutTrajectories((pushed,), np.ones(2), NAMES, UNITS)
    table = rollout_table({"polynomial": oscillator()}, held_out, SMOOTH)
    assert table["error_percent"].max() < 1e-7
    assert table["own_energy_drift_percent"].isna().all()
    cost = rollout_cost({"polynomial": oscillator()}, held_out, SMOOTH, repeats=1)
    assert cost["error_percent"].max() < 1.0
    alone = HeldOutTrajectories((HeldOut(0, t, pushed.x),), np.ones(2), NAMES, UNITS)
    assert rollout_table({"polynomial": oscillator()}, alone, SMOOTH)["error_percent"].min() > 10.0


def test_the_data_are_drawn_beside_every_surrogate(held_out):
    curves = rollout_curves({"polynomial": oscillator()}, held_out, SMOOTH, drawn=1)
    assert set(curves["trajectory"]) == {3}
    assert dict(zip(curves["state"], curves["unit"], strict=True)) == dict(zip(NAMES, UNITS, strict=True))
    data = curves[(curves["model"] == "data") & (curves["state"] == "q")]
    np.testing.assert_array_equal(data["value"], held_out.trajectories[0].x[:, 0])
    assert (curves["model"] == "polynomial").sum() > 5 * (curves["model"] == "data").sum()


def test_costs_are_of_every_implementation(held_out):
    cost = rollout_cost({"polynomial": oscillator()}, held_out, SMOOTH, repeats=2)
    assert set(cost["implementation"]) == {"numpy", "compiled"}
    mine = cost[cost["integrator"] == SMOOTH.label].iloc[0]
    assert mine["simulations"] == 2
    assert mine["diverged"] == 0
    per_call = 1e6 * mine["wall_s_mean"] / mine["right_hand_sides"]
    assert mine["us_per_right_hand_side"] == pytest.approx(per_call)


@pytest.mark.parametrize("task", TASKS.values(), ids=lambda task: task.name)
def test_recordings_are_noisy_states_with_exact_derivatives(task):
    noisy = recordings(task, seed=0, trajectories=20)
    assert noisy.groupby("trajectory").size().tolist() == [task.samples] * 20
    x = noisy[["q", "p"]].to_numpy()
    # the noise of the states is what sets the two sides of the equations apart
    apart = noisy["dq_dt"] - task.derivative(0.0, x)[:, 0]
    slope = 2.0 if not task.friction else np.hypot(2.0, task.friction)
    assert apart.std() == pytest.approx(0.1 * slope, rel=0.1)
    pd.testing.assert_frame_equal(noisy, recordings(task, seed=0, trajectories=20))


def test_the_exact_field_scores_nothing_on_its_task():
    x, dx = grid(TASKS["damped_spring"])
    assert x.shape == (625, 2)
    assert rate_mse(TASKS["damped_spring"], x, dx) == 0.0
    assert rate_mse(SPRING, x, dx) == pytest.approx(np.mean((2.0 * x[:, 0]) ** 2) / 2.0)


def test_energy_is_that_of_the_paper_and_counts_every_loss_of_it():
    exact = compiled(oscillator())
    assert energy_mse(SPRING, exact, 0, SMOOTH) < 1e-12
    assert energy_mse(PENDULUM, exact, 0, SMOOTH) > 1e-3
    assert energy_mse(SPRING, TASKS["damped_spring"], 0, Integrator(method="scipy_rk45")) > 1e-2
    assert energy_mse(SPRING, compiled(oscillator(-1e8)), 0, SMOOTH) == np.inf
