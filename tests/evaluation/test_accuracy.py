"""Errors against a tight solution: laws first."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexsurr.evaluation.accuracy import phase_lag, tip_error, tip_error_percent
from flexsurr.evaluation.cases import Case, ReferenceSolution

T = np.linspace(0.0, 4.0, 401)


def reference(amplitude_m: float = 0.5) -> ReferenceSolution:
    tip = np.stack([np.ones_like(T), np.zeros_like(T), amplitude_m * np.sin(10.0 * T - 1.0)], axis=1)
    return ReferenceSolution(
        Case(0, np.zeros(2)), T, np.zeros((T.size, 2)), tip, np.ones_like(T), amplitude_m
    )


def test_a_solution_has_no_error_against_itself():
    exact = reference()
    error = tip_error(exact, exact.motion)
    assert (error.whole_percent, error.short_percent, error.phase_lag_s) == (0.0, 0.0, 0.0)


@given(st.floats(1e-6, 10.0), st.floats(0.0, 2.0 * np.pi), st.floats(0.01, 10.0))
def test_a_shift_is_its_length_over_the_peak_whatever_its_direction(length_m, angle, peak_m):
    exact = reference(peak_m)
    shift = length_m * np.array([np.cos(angle), np.sin(angle), 0.0])
    assert tip_error_percent(exact, exact.motion + shift) == pytest.approx(100.0 * length_m / peak_m)


def test_an_error_that_comes_late_is_not_in_the_first_seconds():
    exact = reference()
    tip = exact.motion + np.where(T > 2.5, 0.1, 0.001)[:, None] * [0.0, 1.0, 0.0]
    error = tip_error(exact, tip)
    assert error.whole_percent == pytest.approx(20.0)
    assert error.short_percent == pytest.approx(0.2)


def test_a_trajectory_that_ends_early_is_judged_up_to_its_end():
    exact = reference()
    tip = exact.motion[:100] + np.array([0.0, 0.0, 0.05])
    assert tip_error_percent(exact, tip).shape == (100,)
    assert tip_error(exact, tip).whole_percent == pytest.approx(10.0)


@given(st.floats(-0.02, 0.02))
def test_phase_lag_is_the_delay(delay_s):
    lag = phase_lag(T, np.sin(10.0 * (T - delay_s) - 1.0), np.sin(10.0 * T - 1.0))
    assert lag == pytest.approx(delay_s, abs=1e-4)


def test_phase_lag_is_unknown_where_the_oscillations_do_not_match():
    assert np.isnan(phase_lag(T, np.sin(13.0 * T - 1.0), np.sin(10.0 * T - 1.0)))
    assert np.isnan(phase_lag(T, np.ones_like(T), np.sin(10.0 * T - 1.0)))
