"""Mean and spread over the seeds of a configuration."""

import math

import pandas as pd
import pytest

from flexsurr.report.run_tables import seeds


def run(seed: int, nmse: float | None, error: float | None = None, configuration: str = "hnn-0", **other):
    return {
        "study": "cantilever",
        "variant": "hamiltonian",
        "run_id": f"{configuration}-{seed}",
        "configuration": configuration,
        "architecture": "hnn",
        "hidden": "16",
        "activation": "half_log",
        "degree": None,
        "optimiser": "levenberg_marquardt",
        "status": "failed" if nmse is None else "finished",
        "wall_s": 2.0 + seed,
        "validation_nmse": nmse,
        "long_response_error_percent_worst": error,
        "diverged": 0,
    } | other


def test_seeds_of_a_configuration_are_one_row_with_geometric_mean_and_spread():
    table = seeds(pd.DataFrame([run(0, 1e-8, 1.0), run(1, 1e-10, 3.0), run(0, 1e-4, 9.0, "hnn-1")]))
    assert list(table["configuration"]) == ["hnn-0", "hnn-1"]  # best first
    row = table.iloc[0]
    assert (row["seeds"], row["failed"], row["diverged"]) == (2, 0, 0)
    assert row["validation_nmse_mean"] == pytest.approx(1e-9)
    assert row["validation_nmse_std_decades"] == pytest.approx(math.sqrt(2.0))
    assert (row["wall_s_mean"], row["wall_s_std"]) == (2.5, pytest.approx(math.sqrt(0.5)))
    assert (row["long_response_error_percent_mean"], row["long_response_error_percent_std"]) == (
        2.0,
        pytest.approx(math.sqrt(2.0)),
    )
    assert math.isnan(table.iloc[1]["validation_nmse_std_decades"])


def test_a_failed_seed_is_counted_and_left_out():
    row = seeds(pd.DataFrame([run(0, 1e-8, 1.0), run(1, None)])).iloc[0]
    assert (row["seeds"], row["failed"]) == (2, 1)
    assert row["validation_nmse_mean"] == pytest.approx(1e-8)


def test_a_sweep_of_which_every_run_failed_has_its_rows():
    metrics = pd.DataFrame([run(0, None), run(1, None)])
    table = seeds(metrics.drop(columns=["long_response_error_percent_worst", "diverged"]))
    assert list(table["failed"]) == [2]
    assert table["validation_nmse_mean"].isna().all()
