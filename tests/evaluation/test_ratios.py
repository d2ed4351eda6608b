"""Ratios to the three baselines, on wall times made up for the purpose."""

import math

import numpy as np
import pandas as pd
import pytest

from flexsurr.evaluation.published import beside
from flexsurr.evaluation.ratios import relative_percent, summary


def measurements(*rows) -> pd.DataFrame:
    frame = pd.DataFrame(
        rows, columns=["model", "implementation", "integrator", "simulation", "wall_s", "completed"]
    )
    return frame.assign(
        tip_error_percent=[float(k) for k in range(len(frame))],
        tip_error_2s_percent=0.1,
        phase_lag_s=-0.2,
        energy_drift_percent=1.0,
        own_energy_drift_percent=float("nan"),
    )


RADAU, ORDER_8 = "scipy_radau", "dop853_fixed(h=0.01)"

EXAMPLE = measurements(
    ("rom", "described", RADAU, 0, 10.0, True),
    ("rom", "described", RADAU, 1, 20.0, True),
    ("rom", "numpy", RADAU, 0, 2.0, True),
    ("rom", "numpy", RADAU, 1, 2.0, True),
    ("rom", "compiled", RADAU, 0, 1.0, True),
    ("rom", "compiled", RADAU, 1, 1.0, True),
    ("rom", "compiled", ORDER_8, 0, 0.1, True),
    ("rom", "compiled", ORDER_8, 1, 0.1, True),
    ("rom", "compiled", ORDER_8, 2, 0.1, True),
    ("hnn", "torch", RADAU, 0, 5.0, True),
    ("hnn", "compiled", RADAU, 0, 0.5, True),
    ("hnn", "compiled", ORDER_8, 0, 0.02, True),
    ("hnn", "compiled", ORDER_8, 1, 0.01, True),
    ("hnn", "compiled", ORDER_8, 2, 0.09, False),
    ("mlp", "compiled", ORDER_8, 0, 0.01, False),
)


@pytest.fixture
def table():
    return summary(EXAMPLE).set_index(["model", "implementation", "integrator"])


def test_each_baseline_costs_all_of_itself(table):
    for baseline in ("described", "numpy", "compiled"):
        row = table.loc["rom", baseline, RADAU]
        assert row[f"relative_to_{baseline}_percent"] == 100.0
        assert row[f"relative_to_{baseline}_std_percent"] == 0.0


def test_ratios_are_means_over_pairs_of_the_same_simulation(table):
    row = table.loc["hnn", "compiled", ORDER_8]
    # 0.02/10 and 0.01/20, not the ratio of the means
    assert row["relative_to_described_percent"] == pytest.approx(np.mean([0.2, 0.05]))
    assert row["relative_to_described_std_percent"] == pytest.approx(np.std([0.2, 0.05], ddof=1))
    assert row["relative_to_numpy_percent"] == pytest.approx(np.mean([1.0, 0.5]))


def test_a_compiled_integrator_is_compared_with_the_compiled_model_in_the_same_integrator(table):
    assert table.loc["hnn", "compiled", ORDER_8]["relative_to_compiled_percent"] == pytest.approx(15.0)
    assert table.loc["hnn", "compiled", RADAU]["relative_to_compiled_percent"] == pytest.approx(50.0)
    assert table.loc["hnn", "torch", RADAU]["relative_to_compiled_percent"] == pytest.approx(500.0)


def test_a_diverged_simulation_is_counted_and_its_time_left_out(table):
    row = table.loc["hnn", "compiled", ORDER_8]
    assert (row["simulations"], row["diverged"]) == (3, 1)
    assert row["wall_s_mean"] == pytest.approx(0.015)
    assert row["tip_error_percent"] == 12.0  # the worst of those that finished


def test_where_every_simulation_diverged_nothing_is_claimed(table):
    row = table.loc["mlp", "compiled", ORDER_8]
    assert (row["simulations"], row["diverged"]) == (1, 1)
    assert row.drop(["simulations", "diverged"]).isna().all()


def test_one_simulation_has_no_spread(table):
    row = table.loc["hnn", "torch", RADAU]
    assert row["relative_to_described_percent"] == 50.0
    assert np.isnan(row["relative_to_described_std_percent"])
    assert np.isnan(row["wall_s_std"])


def test_without_a_common_simulation_there_is_no_ratio():
    assert np.isnan(relative_percent(pd.Series({1: 1.0}), pd.Series({2: 1.0}))[0])
    assert np.isnan(relative_percent(None, pd.Series({2: 1.0}))[0])


def test_the_published_figure_stands_beside_the_network_of_the_recipe_in_torch_alone():
    models = ["hnn", "hnn", "mlp", "hnn_small", "hnn", "hnn"]
    responses = ["free", "forced", "free", "free", "free", "free"]
    forms = [*["torch"] * 4, "compiled", "torch"]
    integrators = [*["scipy_radau"] * 5, "dop853_fixed(h=0.01)"]
    costs = pd.DataFrame(
        {"model": models, "response": responses, "implementation": forms, "integrator": integrators}
    )
    nan = math.nan
    recipes = {"hnn": "hnn", "mlp": "mlp"}
    found = beside(costs, "cantilever", recipes)
    np.testing.assert_array_equal(found["paper_percent"], [1.29, 83.60, 0.78, nan, nan, nan])
    np.testing.assert_array_equal(found["paper_std_percent"], [0.07, 4.63, 0.06, nan, nan, nan])
    named = beside(costs, "cantilever", {"hnn_small": "hnn"})
    np.testing.assert_array_equal(named["paper_percent"], [nan, nan, nan, 1.29, nan, nan])
    for others in (beside(costs, "elsewhere", recipes), beside(costs, "cantilever", {})):
        assert others["paper_percent"].isna().all()
