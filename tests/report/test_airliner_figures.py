"""The airliner's figures show what they are given, in the units they say."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex

from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES
from flexsurr.report.airliner_flight_figures import (
    AILERON_SHOWN,
    ELEVATOR_SHOWN,
    RUDDER_SHOWN,
    figure_18,
    figure_19,
    figure_20,
    figure_21,
)
from flexsurr.report.airliner_learning_figures import coefficient_errors
from flexsurr.report.style import BLUE

TIMES_S = (0.5, 1.5, 2.5)


@pytest.fixture
def errors() -> pd.DataFrame:
    """Errors of 1 % everywhere, but 10 % of one output at large angles of attack."""
    generator = np.random.default_rng(0)
    frame = pd.DataFrame(generator.uniform(-0.1, 0.1, (400, len(FEATURES))), columns=list(FEATURES))
    frame[[f"error_{name}" for name in COEFFICIENTS]] = 0.01
    frame.loc[frame["alpha"] > 0.05, "error_C_L"] = -0.1
    return frame


def test_errors_have_a_panel_an_input_and_rise_where_they_rise(errors):
    figure = coefficient_errors(errors)
    panels = [ax for ax in figure.axes if ax.get_visible()]
    assert len(panels) == len(FEATURES)
    assert len({ax.get_xlabel() for ax in panels}) == len(FEATURES)
    alpha = panels[FEATURES.index("alpha")]
    (line,) = (line for line in alpha.lines if to_hex(line.get_color()) == to_hex(BLUE))
    assert np.degrees(-0.1) < line.get_xdata().min() < line.get_xdata().max() < np.degrees(0.1)
    assert line.get_ydata()[0] == pytest.approx(1.0)
    assert line.get_ydata()[-1] == pytest.approx(np.sqrt((11 * 1.0 + 100.0) / 12))


def test_eigenvalues_of_both_models_stand_where_they_are():
    modes = pd.DataFrame(
        {
            "mode": ["short period", "spiral", "elastic 1"],
            "reference_real": [-1.0, -0.03, -2.0],
            "reference_imag": [2.0, 0.0, 14.0],
            "surrogate_real": [-1.01, -0.031, -2.1],
            "surrogate_imag": [2.02, 0.0, 14.1],
        }
    )
    everything, near = figure_18(modes).axes
    for ax, count in ((everything, 3), (near, 2)):
        reference, surrogate = ax.lines[:2]
        np.testing.assert_array_equal(reference.get_ydata(), modes["reference_imag"][:count])
        np.testing.assert_array_equal(surrogate.get_xdata(), modes["surrogate_real"][:count])


@pytest.mark.parametrize(
    ("draw", "shown"),
    [(figure_19, ELEVATOR_SHOWN), (figure_20, AILERON_SHOWN), (figure_21, RUDDER_SHOWN)],
)
def test_a_doublet_shows_both_histories_and_their_difference(draw, shown):
    t = np.linspace(0.0, 5.0, 101)
    lattice = pd.DataFrame({"t_s": t, **{name: np.sin(t) for name in shown}})
    network = pd.DataFrame({"t_s": t, **{name: 1.02 * np.sin(t) for name in shown}})
    panels = draw({"vlm_frozen": lattice, "network": network}, TIMES_S).axes
    assert len(panels) == len(shown)
    for ax in panels:
        np.testing.assert_array_equal(ax.lines[1].get_ydata(), network[shown[0]])
        assert "2 % of the peak" in ax.get_title(loc="left")
