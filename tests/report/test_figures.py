"""Every figure: drawn, labelled, nothing empty, and the same bytes each time."""

import re

import matplotlib
import pytest
from matplotlib.figure import Figure

from flexsurr.report import FIGURES, save

# The fixture that stands for each thing a figure may read.
FIXTURES = {
    "structure": "structure",
    "statics": "statics",
    "validation": "validation",
    "response-*-free": "free",
    "response-*-forced": "forced",
    "energy-*": "energy",
    "cost-*-*": "cost",
    "metrics": "metrics",
    "history": "history",
}

SCHEMATIC = ("figure_03", "figure_04", "figure_05", "figure_06", "figure_11")


DRAWN: dict[str, Figure] = {}


def draw(name, request):
    product = FIGURES[name]
    return product.make(*(request.getfixturevalue(FIXTURES[read]) for read in product.reads))


@pytest.fixture
def figure(name, request):
    """The figure of that name, drawn once for all tests that only look at it."""
    if name not in DRAWN:
        DRAWN[name] = draw(name, request)
    return DRAWN[name]


@pytest.mark.parametrize("name", FIGURES)
def test_no_axes_are_empty(figure):
    for ax in figure.axes:
        assert ax.has_data() or ax.patches


@pytest.mark.parametrize("name", [name for name in FIGURES if name not in SCHEMATIC])
def test_every_axis_has_a_label_with_its_unit(figure):
    for ax in figure.axes:
        subplots = ax.get_subplotspec()
        if subplots.is_last_row():
            assert "[" in ax.get_xlabel()
        if subplots.is_first_col():
            assert re.search(r"\[.+\]|nmse", ax.get_ylabel())


@pytest.mark.parametrize("name", [name for name in FIGURES if name not in SCHEMATIC])
def test_what_is_drawn_is_explained(figure):
    assert figure.legends or any(ax.get_legend() for ax in figure.axes)


@pytest.mark.parametrize("name", FIGURES)
def test_saved_twice_it_is_the_same_file(name, request, tmp_path):
    for attempt in ("first", "second"):
        save(draw(name, request), tmp_path / attempt / name)
    for suffix in ("svg", "png"):
        first, second = (
            (tmp_path / attempt / f"{name}.{suffix}").read_bytes() for attempt in ("first", "second")
        )
        assert first == second
        assert len(first) > 1000
    assert sorted(path.name for path in (tmp_path / "first").iterdir()) == [f"{name}.png", f"{name}.svg"]


def test_the_callers_settings_neither_matter_nor_change(request):
    with matplotlib.rc_context({"font.size": 30.0, "axes.grid": False}):
        figure = draw("figure_08", request)
        assert matplotlib.rcParams["font.size"] == 30.0
    assert figure.axes[0].xaxis.label.get_size() < 10.0


@pytest.mark.parametrize("name", ["figure_09", "figure_10", "figure_12", "figure_13", "cost_accuracy"])
def test_a_study_of_one_variant_is_drawn_too(name, request):
    product = FIGURES[name]
    frame = request.getfixturevalue(FIXTURES[product.reads[0]])
    figure = product.make(frame[frame["variant"] == "as_printed"])
    assert all(ax.has_data() for ax in figure.axes)


def test_the_whole_pareto_front_is_labelled(request):
    from flexsurr.report.cost_figures import pareto_front

    cost = request.getfixturevalue("cost")
    panel = cost[(cost["variant"] == "hamiltonian") & (cost["response"] == "free")]
    written = " ".join(text.get_text() for text in draw("cost_accuracy", request).axes[0].texts)
    front = pareto_front(panel)
    assert len(front) >= 2
    assert set(front["integrator"]) == {"dop853_fixed(h=0.01)", "rk4(h=0.001)"}
    assert "polynomial H, order 8" in written
    assert "polynomial H, RK4" in written
