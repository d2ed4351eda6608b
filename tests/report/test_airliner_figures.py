"""The airliner's figures show what they are given, in the units they say."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex

from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES
from flexsurr.config.flight import DoubletTimes
from flexsurr.report.airliner_flight_figures import (
    LATERAL,
    LONGITUDINAL,
    aileron_doublet,
    figure_18,
    figure_19,
    figure_20,
    figure_21,
    rudder_doublet,
)
from flexsurr.report.style import BLUE
from flexsurr.report.training_figures import coefficient_errors


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


ELASTIC = pd.DataFrame(
    {
        "mode": [1, 2, 3, 5],
        "symmetric": [True, False, True, False],
        "in_aerodynamics": [True, True, False, True],
        "name": ["wing bending", "wing torsion", "engine nodding", "engine sway"],
    }
)
ETAS = ("eta_1", "eta_2", "eta_5")


def histories(control: str, network: float) -> pd.DataFrame:
    """Sines in every quantity; the network's are `network` times the lattice's."""
    t = np.linspace(0.0, 5.0, 101)
    return pd.concat(
        pd.DataFrame(
            {
                "model": model,
                "control": control,
                "t_s": t,
                **{name: factor * np.sin(t) for name in (*LONGITUDINAL, *LATERAL, *ETAS)},
            }
        )
        for model, factor in (("vlm_frozen", 1.0), ("network", network))
    )


@pytest.mark.parametrize(
    ("draw", "control", "shown"),
    [
        (figure_19, "elevator", LONGITUDINAL),
        (figure_20, "elevator", LATERAL),
        (figure_21, "elevator", ETAS),
        (aileron_doublet, "aileron", (*LATERAL, "eta_2", "eta_5")),
        (rudder_doublet, "rudder", (*LATERAL, "eta_2", "eta_5")),
    ],
)
def test_a_doublet_shows_both_histories_and_their_difference(draw, control, shown):
    doublets = pd.concat([histories(control, 1.02), histories("of another control", 7.0)])
    reads = (doublets, DoubletTimes(), ELASTIC)
    panels = [ax for ax in draw(*reads[: 3 if shown[-1] == "eta_5" else 2]).axes if ax.get_visible()]
    assert len(panels) == len(shown)
    for ax in panels:
        np.testing.assert_allclose(ax.lines[1].get_ydata(), 1.02 * ax.lines[0].get_ydata())
        assert "2 % of the peak" in ax.get_title(loc="left")


def test_what_is_rounding_in_the_lattice_is_no_percentage():
    doublets = histories("elevator", 1e9)
    doublets[list(LATERAL)] *= 1e-12
    titles = [ax.get_title(loc="left") for ax in figure_20(doublets, DoubletTimes()).axes]
    assert all("lattice 1e-12, network 1e-03 at most" in title for title in titles)


def test_antisymmetric_modes_are_named_where_they_are_shown():
    titles = [
        ax.get_title(loc="left")
        for ax in rudder_doublet(histories("rudder", 1.0), DoubletTimes(), ELASTIC).axes
    ]
    assert [title.split("  ")[1].split("\n")[0] for title in titles[6:8]] == ["wing torsion", "engine sway"]
