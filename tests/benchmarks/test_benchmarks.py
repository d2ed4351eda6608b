"""How benchmarks time, the table of all that they timed, and that what they take from flexsurr is there."""

import ast
import csv
import importlib
import runpy
import sys
import time
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def timing(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    monkeypatch.delitem(sys.modules, "timing", raising=False)
    import timing

    yield timing
    sys.modules.pop("timing")


@pytest.fixture
def clock(monkeypatch, timing):
    """Time that passes when a call says so."""
    now = [0.0]
    monkeypatch.setattr(time, "perf_counter", lambda: now[0])
    return now


def passing(clock, seconds):
    """A call that takes each of these in turn, for ever."""
    turns = iter(seconds * 100)

    def call():
        clock[0] += next(turns)

    return call


def test_a_slow_spell_of_the_machine_leaves_ratios_alone(timing, clock):
    slow = [1.0, 1.0, 5.0, 1.0, 3.0]
    calls = {"first": passing(clock, slow), "second": passing(clock, [2.0 * s for s in slow])}
    found = timing.compare("two calls", calls, repeats=50, warmup=0)
    assert found["second"].ratio == pytest.approx(2.0)
    assert found["second"].ratio_spread == pytest.approx(0.0, abs=1e-12)
    assert found["first"].ratio == pytest.approx(1.0)
    assert found["first"].lowest_s == pytest.approx(1.0)


def test_a_call_that_works_many_times_over_is_reported_by_one(timing, clock):
    calls = {"one": passing(clock, [3.0]), "ten": passing(clock, [10.0])}
    found = timing.compare("two calls", calls, repeats=4, warmup=1, counts={"ten": 10})
    assert found["ten"].median_s == pytest.approx(1.0)
    assert found["ten"].ratio == pytest.approx(1.0 / 3.0)


def test_each_timing_is_a_row_where_a_file_is_named(timing, clock, tmp_path, monkeypatch):
    rows = tmp_path / "rows.csv"
    monkeypatch.setenv(timing.ROWS, str(rows))
    timing.compare("two calls", {"a": passing(clock, [1.0]), "b": passing(clock, [4.0])}, repeats=3)
    found = list(csv.DictReader(rows.read_text().splitlines(), timing.COLUMNS))
    assert [(row["work"], row["peer"], row["ours"]) for row in found] == [
        ("two calls", "a", "a"),
        ("two calls", "b", "a"),
    ]
    assert [float(row["ratio"]) for row in found] == [1.0, 4.0]


def test_one_repeat_has_no_spread(timing):
    with pytest.raises(ValueError, match="two repeats"):
        timing.compare("one call", {"a": lambda: None}, repeats=1)


def test_one_sitting_runs_every_benchmark_of_speed(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    listed = runpy.run_path(BENCHMARKS / "run.py")["BENCHMARKS"]
    timed = {
        path.stem
        for path in BENCHMARKS.glob("*.py")
        if "from timing import" in path.read_text() and "__main__" in path.read_text()
    }
    assert timed - {"run"} <= set(listed)
    assert all((BENCHMARKS / f"{name}.py").exists() for name in listed)


@pytest.mark.parametrize("script", sorted(BENCHMARKS.glob("*.py")), ids=lambda path: path.stem)
def test_what_a_benchmark_takes_from_flexsurr_is_there(script):
    """No test runs them all: what is renamed shows here."""
    for node in ast.walk(ast.parse(script.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("flexsurr"):
            module = importlib.import_module(node.module)
            for name in node.names:
                if not hasattr(module, name.name):
                    importlib.import_module(f"{node.module}.{name.name}")
