"""Where a network pays: its table and its figure, of numbers made up."""

import pandas as pd
import pytest

from flexsurr.evaluation.columns import CROSSOVER_COLUMNS
from flexsurr.report.crossover_figure import cheapest, crossover
from flexsurr.report.style import save
from flexsurr.report.tables import TABULATE

MODELS = {
    "polynomial_2": (20, 3.0, 5.0),
    "polynomial_4": (400, 40.0, 0.05),
    "polynomial_4_sparse": (60, 9.0, 0.06),
    "polynomial_6_sparse": (200, 15.0, 0.001),
    "network_16_atan": (150, 12.0, 0.3),
    "network_32_atan_mirrored": (300, 18.0, 0.04),
}


@pytest.fixture
def table() -> pd.DataFrame:
    rows = []
    for modes in (3, 8):
        rows.append((modes, "rom", None, 0.4 * modes, 100.0, 1e-7, 0, 16000, ""))
        for model, (parameters, cost, error) in MODELS.items():
            bad = modes == 8 and model == "polynomial_4_sparse"
            wall_s = 0.004 * modes * cost
            rows.append((modes, model, parameters, wall_s, cost, error, 2 * bad, parameters, f"run-{model}"))
    frame = pd.DataFrame(rows, columns=list(CROSSOVER_COLUMNS))
    return frame.astype({"parameters": "Int64"})


def test_the_reduced_model_comes_first_then_the_cheapest(table):
    made = TABULATE["crossover"](table.sample(frac=1.0, random_state=1).assign(surplus=1.0))
    assert tuple(made.columns) == CROSSOVER_COLUMNS
    assert made["modes"].is_monotonic_increasing
    for _, of_modes in made.groupby("modes"):
        assert of_modes["model"].iloc[0] == "rom"
        assert of_modes["wall_s"].iloc[1:].is_monotonic_increasing


def test_the_cheapest_of_each_kind_strays_by_no_more_than_is_allowed(table):
    found = cheapest(table).set_index(["modes", "family"])["model"]
    assert found[3].to_dict() == {
        "full polynomial": "polynomial_4",
        "network": "network_32_atan_mirrored",
        "sparse polynomial": "polynomial_4_sparse",
    }
    assert found[8, "sparse polynomial"] == "polynomial_6_sparse"  # of the other two responses have diverged
    assert set(cheapest(table, 0.01)["model"]) == {"polynomial_6_sparse"}


def test_there_is_a_panel_for_each_number_of_modes_and_one_for_the_answer(table, tmp_path):
    figure = crossover(table)
    titles = [ax.get_title(loc="left") for ax in figure.axes]
    assert titles == ["(a)  3 modes", "(b)  8 modes", "(c)  The cheapest within 0.1 %"]
    assert all(ax.has_data() and "[" in ax.get_xlabel() and "[" in ax.get_ylabel() for ax in figure.axes)
    assert figure.legends
    first, second = (save(crossover(table), tmp_path / name / "crossover") for name in ("a", "b"))
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]


def test_where_no_run_has_finished_the_reduced_model_is_drawn(table):
    assert crossover(table[table["model"] == "rom"]).axes
