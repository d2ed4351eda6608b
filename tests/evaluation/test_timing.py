"""Wall times: the arithmetic of the clock, never its readings."""

import gc
import itertools
import os
from functools import partial

import pytest

from flexsurr.evaluation import timing


def test_the_median_of_the_repeats_is_reported(monkeypatch):
    readings = itertools.chain.from_iterable((0.0, seconds) for seconds in (9.0, 1.0, 3.0))
    monkeypatch.setattr(timing, "perf_counter", lambda: next(readings))
    calls = []
    result, wall_s = timing.wall_time(lambda: calls.append(1) or len(calls), repeats=3)
    assert (result, wall_s) == (3, 3.0)


def test_what_takes_long_is_repeated_until_it_is_enough(monkeypatch):
    readings = itertools.chain.from_iterable((0.0, seconds) for seconds in (0.07, 0.05, 9.0))
    monkeypatch.setattr(timing, "perf_counter", lambda: next(readings))
    calls = []
    _, wall_s = timing.wall_time(lambda: calls.append(1), repeats=3, enough_s=0.1)
    assert (len(calls), wall_s) == (2, pytest.approx(0.06))


def test_time_is_positive_and_no_garbage_is_collected_meanwhile():
    collecting, wall_s = timing.wall_time(gc.isenabled)
    assert wall_s > 0.0
    assert not collecting
    assert gc.isenabled()


def test_collection_is_switched_on_again_after_a_failure():
    with pytest.raises(ZeroDivisionError):
        timing.wall_time(lambda: 1 / 0)
    assert gc.isenabled()


def test_what_is_there_is_exempt_from_collection_while_a_series_is_measured():
    before = gc.get_freeze_count()
    with timing.measuring():
        assert gc.get_freeze_count() > before + 1000
        assert timing.wall_time(lambda: 1)[0] == 1
    assert gc.get_freeze_count() == 0


def test_at_least_one_repeat():
    with pytest.raises(ValueError, match="at least 1"):
        timing.wall_time(lambda: None, repeats=0)


def test_what_is_compiled_ahead_is_called_once_each_and_an_error_waits_for_its_own_call(tmp_path):
    def first(number):
        (tmp_path / str(number)).write_text(str(os.getpid()))
        if number == 1:
            raise ArithmeticError("diverged")

    timing.compile_ahead(partial(first, number) for number in range(5))
    written = {path.name: path.read_text() for path in tmp_path.iterdir()}
    cores = len(os.sched_getaffinity(0))
    if cores == 1:
        assert written == {}
    else:
        assert sorted(written) == ["0", "1", "2", "3", "4"]
        assert len(set(written.values())) == min(cores, 5)
        assert str(os.getpid()) not in written.values()
