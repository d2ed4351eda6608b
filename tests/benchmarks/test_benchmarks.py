"""How benchmarks time, the table of all that they timed, and that what they take from flexsurr is there."""

import ast
import importlib
import json
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


@pytest.fixture
def rows(timing, tmp_path, monkeypatch):
    """The rows that were kept since, as a list of dicts."""
    path = tmp_path / "rows.jsonl"
    monkeypatch.setenv(timing.ROWS, str(path))
    return lambda: [json.loads(line) for line in path.read_text().splitlines()]


def test_each_timing_is_a_row_where_a_file_is_named(timing, clock, rows):
    calls = {"a": passing(clock, [1.0]), "b": passing(clock, [4.0])}
    timing.compare("two calls", calls, repeats=3, errors={"b": 0.1}, more={"b": {"operations": 7}})
    found = rows()
    assert [(row["work"], row["peer"], row["ours"]) for row in found] == [
        ("two calls", "a", "a"),
        ("two calls", "b", "a"),
    ]
    assert [row["ratio"] for row in found] == [1.0, 4.0]
    assert [row.get("operations") for row in found] == [None, 7]
    assert [(row["error_ours"], row["error_peer"]) for row in found] == [(None, None), (None, 0.1)]


def test_what_was_run_once_is_a_row_without_a_spread(timing, rows):
    timing.record("to a mark", {"a": 2.0, "b": 6.0, "c": None})
    assert [(row["peer_s"], row["ratio"], row["ratio_spread"]) for row in rows()] == [
        (2.0, 1.0, None),
        (6.0, 3.0, None),
        (None, None, None),
    ]


def test_a_benchmark_that_runs_again_replaces_its_own_rows_alone(sitting, timing):
    def table(*rows):
        lines = [json.dumps({"subject": s, "work": w} | more) for s, w, more in rows]
        return sitting["table_of"](lines)

    before = table(("integrators", "old", {}), ("training", "kept", {}))
    now = table(("scaling", "new", {"size": 10.0}), ("integrators", "new", {}))
    found = sitting["merged"](before, now)
    assert list(found.columns)[: len(timing.COLUMNS)] == timing.COLUMNS
    assert list(zip(found["subject"], found["work"], strict=True)) == [
        ("integrators", "new"),
        ("scaling", "new"),
        ("training", "kept"),
    ]
    assert found["size"].dropna().tolist() == [10.0]


def test_one_repeat_has_no_spread(timing):
    with pytest.raises(ValueError, match="two repeats"):
        timing.compare("one call", {"a": lambda: None}, repeats=1)


@pytest.fixture
def sitting(timing):
    return runpy.run_path(str(BENCHMARKS / "run.py"))


def test_one_sitting_runs_every_benchmark_of_speed(sitting):
    listed = sitting["BENCHMARKS"]
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
