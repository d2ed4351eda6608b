"""The tables of the documents, written from results."""

import runpy
from pathlib import Path

import pandas as pd
import pytest
import speed_tables

DOCS = Path(__file__).parents[2] / "docs"
TABLES = runpy.run_path(str(DOCS / "tables.py"))
COST = ["variant", "response", "model", "implementation", "integrator", "wall_s_mean"]
COST += [f"relative_to_{name}_percent" for name in ("described", "numpy", "compiled")] + ["tip_error_percent"]
WAYS = (("numpy", "scipy_radau"), ("compiled", "dop853_fixed(h=0.01)"), ("compiled", "rk4(h=0.001)"))


@pytest.fixture
def results(tmp_path):
    """A study that tells its costs by the method of order 8, and has another beside it."""
    rows = [
        ("rom", "described", "scipy_radau", 30.6, 100.0, 3110.0, 5740.0, 11.9),
        *(("rom", *way, 0.0037, 0.0123, 0.41, 100.0, 2e-4) for way in WAYS),
        *(("hnn", *way, 0.0009, 0.0034, 0.11, 25.0, 2e-4) for way in WAYS),
        ("hnn", "torch", "scipy_radau", 6.4, 20.0, 655.0, 1120.0, float("nan")),
    ]
    (tmp_path / "tables/cantilever").mkdir(parents=True)
    frame = pd.DataFrame([("hamiltonian", "free", *row) for row in rows], columns=COST)
    frame.to_csv(tmp_path / "tables/cantilever/cost.csv", index=False)
    return tmp_path


def test_every_mark_is_of_a_table_and_every_table_is_marked_once():
    marks = [
        mark["name"]
        for name in TABLES["DOCUMENTS"]
        for mark in TABLES["MARKED"].finditer((DOCS.parent / name).read_text(encoding="utf-8"))
    ]
    assert sorted(marks) == sorted(TABLES["TABLES"])


def test_a_marked_table_says_what_the_results_hold_and_the_words_around_it_stay(results):
    text = "Before.\n\n<!-- table: cost of the cantilever, free -->\n\nold\n\n<!-- end of table -->\n\nAfter."
    written = TABLES["written"](text, results)
    assert written.startswith("Before.\n")
    assert written.endswith("\nAfter.")
    assert "old" not in written
    _, _, *rows = [line for line in written.splitlines() if "|" in line]
    assert rows == [
        "| reduced model | described, SciPy Radau | 31 | 100 % | 3,100 % | 5,700 % | 12 % |",
        "|  | numpy, SciPy Radau | 0.0037 | 0.012 % | 0.41 % | 100 % | 2.0e-4 % |",
        "|  | compiled, order 8, fixed step | 0.0037 | 0.012 % | 0.41 % | 100 % | 2.0e-4 % |",
        "| HNN | compiled, order 8, fixed step | 9.0e-4 | 0.0034 % | 0.11 % | 25 % | 2.0e-4 % |",
        "|  | torch, SciPy Radau | 6.4 | 20 % | 660 % | 1,100 % |  |",
    ]
    assert TABLES["written"](written, results) == written


def test_a_table_without_results_is_left_as_it_is(tmp_path, capsys):
    text = "<!-- table: crossover -->\n\nas before\n\n<!-- end of table -->"
    assert TABLES["written"](text, tmp_path) == text
    assert "crossover: left as it is" in capsys.readouterr().out


MACHINE = {"processor": "a", "cores": 2, "python": 3, "numpy": 2, "numba": 1, "scipy": 1, "torch": 2}


def measured(folder, rows):
    """A folder of results that holds these rows of benchmarks.csv."""
    (folder / "tables").mkdir()
    frame = pd.DataFrame([MACHINE | {"commit": "0" * 40} | row for row in rows])
    frame.to_csv(folder / "tables/benchmarks.csv", index=False)
    return folder


def run_of(code, error, seconds):
    return {
        "subject": "peers_of_the_beam",
        "work": "30 s",
        "peer": code,
        "error_peer": error,
        "peer_s": seconds,
    }


def test_runs_are_compared_at_nearest_errors_without_those_that_another_beats(tmp_path):
    ours = [("flexsurr, rtol 1", 1e-3, 0.01), ("flexsurr, rtol 2", 1e-5, 0.1), ("flexsurr, worse", 1e-2, 1.0)]
    theirs = [("Other, step 1", 2e-3, 0.5), ("Other, step 2", 5e-4, 2.0), ("Far, step 1", 1e-8, 9.0)]
    results = measured(tmp_path, [run_of(*run) for run in ours + theirs])
    assert speed_tables.equal_errors(results).splitlines()[2:] == [
        "| 30 s | Other | 2.0e-3 in 500 ms, step 1 | 1.0e-3 in 10.0 ms, rtol 1 | 50 |",
        "|  |  | 5.0e-4 in 2.00 s, step 2 | 1.0e-3 in 10.0 ms, rtol 1 | 200 |",
    ]


def test_a_benchmark_that_was_not_run_leaves_its_table_as_it_is(tmp_path, capsys):
    measured(tmp_path, [run_of("flexsurr, rtol 1", 1e-3, 0.01)])
    text = "<!-- table: counted -->\n\nas before\n\n<!-- end of table -->"
    assert TABLES["written"](text, tmp_path) == text
    assert "counted: left as it is" in capsys.readouterr().out


def test_a_fitted_power_stands_beside_the_costs_that_it_is_of(tmp_path):
    of = {"subject": "scaling", "peer": "compiled", "against": "elements"}
    rows = [
        of | {"work": f"right-hand side, elements: {size}", "size": size, "peer_s": seconds}
        for size, seconds in ((10, 1e-6), (20, 4e-6))
    ]
    rows.append(of | {"work": "right-hand side: growth with elements", "exponent": 2.0})
    assert speed_tables.growth(measured(tmp_path, rows)).splitlines()[2:] == [
        "| right-hand side | elements, 10 to 20 | compiled | 1.0 µs, 4.0 µs | 2.0 |"
    ]
