"""Every figure: drawn, labelled, nothing empty, and the same bytes each time."""

import re

import matplotlib
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from flexsurr.report.catalogue import FIGURES
from flexsurr.report.cost_figures import pareto_front
from flexsurr.report.figures import DRAW
from flexsurr.report.style import save

# The fixture that stands for each thing a figure may read.
FIXTURES = {
    "structure": "structure",
    "statics": "statics",
    "shapes": "shapes",
    "validation": "validation",
    "response-*-free": "free",
    "response-*-forced": "forced",
    "response-*-sustained": "sustained",
    "energy-*": "energy",
    "cost-*-*": "cost",
    "metrics": "metrics",
    "sweeps": "sweeps",
    "selection": "selection",
    "history": "history",
    "relatives": "relatives",
    "lattice_operations": "without_lattice",
}
# Figures of damped structures read files of the same names, with other things in them.
OF_DAMPED = {"energy_decay": "damped_energy"}

OF_BEAMS = {name: figure for name, figure in FIGURES.items() if "trajectories" in figure.sources}
"""The airliner's are drawn in test_airliner_figures.py and in tests/flight."""

SCHEMATIC = ("figure_03", "figure_04", "figure_05", "figure_06", "figure_07", "figure_11")


WITHOUT_UNITS = (*SCHEMATIC, "trials")
"""Whose axes are settings, by the names that people give them."""

DRAWN: dict[str, Figure] = {}


def read_by(name, request):
    fixtures = [OF_DAMPED.get(name, FIXTURES[read]) for read in FIGURES[name].reads]
    return [request.getfixturevalue(fixture) for fixture in fixtures]


def draw(name, request):
    return DRAW[name](*read_by(name, request))


@pytest.fixture
def figure(name, request):
    """The figure of that name, drawn once for all tests that only look at it."""
    if name not in DRAWN:
        DRAWN[name] = draw(name, request)
    return DRAWN[name]


def test_every_figure_of_the_catalogue_is_drawn_and_no_other():
    assert set(DRAW) == set(FIGURES)


@pytest.mark.parametrize("name", OF_BEAMS)
def test_no_axes_are_empty(figure):
    for ax in figure.axes:
        assert ax.has_data() or ax.patches


@pytest.mark.parametrize("name", [name for name in OF_BEAMS if name not in WITHOUT_UNITS])
def test_every_axis_has_a_label_with_its_unit(figure):
    for ax in figure.axes:
        subplots = ax.get_subplotspec()
        if subplots.is_last_row():
            assert "[" in ax.get_xlabel()
        if subplots.is_first_col():
            assert re.search(r"\[.+\]|nmse", ax.get_ylabel())


@pytest.mark.parametrize("name", [name for name in OF_BEAMS if name not in SCHEMATIC])
def test_what_is_drawn_is_explained(figure):
    assert figure.legends or any(ax.get_legend() for ax in figure.axes)


@pytest.mark.parametrize("name", OF_BEAMS)
def test_drawn_and_saved_twice_it_is_the_same_file(name, figure, request, tmp_path):
    save(figure, tmp_path / "first" / name)
    save(draw(name, request), tmp_path / "second" / name)
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


OF_VARIANTS = [
    name
    for name, product in OF_BEAMS.items()
    if product.reads and product.reads[-1].split("-")[0] in ("validation", "response", "energy", "cost")
]


@pytest.mark.parametrize("name", [*OF_VARIANTS, "architecture_errors"])
def test_a_study_of_one_variant_is_drawn_too(name, request):
    *others, frame = read_by(name, request)
    figure = DRAW[name](*others, frame[frame["variant"] == "as_printed"])
    assert all(ax.has_data() for ax in figure.axes)


OF_SURROGATES = [
    name
    for name, product in OF_BEAMS.items()
    if any(read.startswith(("response", "energy", "cost", "metrics", "relatives")) for read in product.reads)
]


@pytest.mark.parametrize("name", OF_SURROGATES)
def test_where_no_trial_has_finished_the_references_are_drawn(name, request):
    *others, frame = read_by(name, request)
    if "model" in frame:
        frame = frame[frame["model"].isin(["reference", "rom", "fom"])]
    else:  # of runs: such a study has none that is scored
        scored = [column for column in frame if column.startswith(("held_out", "long_response", "diverged"))]
        frame = frame.drop(columns=scored).assign(status="stopped", reason="", validation_nmse=None)
    assert DRAW[name](*others, frame).axes


def test_the_whole_pareto_front_is_labelled(request):
    cost = request.getfixturevalue("cost")
    panel = cost[(cost["variant"] == "hamiltonian") & (cost["response"] == "free")]
    written = " ".join(text.get_text() for text in draw("cost_accuracy", request).axes[0].texts)
    front = pareto_front(panel)
    assert len(front) >= 2
    assert set(front["integrator"]) == {"dop853_fixed(h=0.01)", "rk4(h=0.001)"}
    assert "polynomial H, order 8" in written
    assert "polynomial H, RK4" in written


def test_what_only_damped_structures_have_is_drawn_of_them_alone(structure):
    damped = structure.model_copy(update={"damping_out_of_plane_s": 0.1})
    undamped_in_torsion = structure.model_copy(update={"damping_torsion_s": 0.1})  # which it has not
    made = {
        name: [figure.shows(beam) for beam in (structure, damped, undamped_in_torsion)]
        for name, figure in OF_BEAMS.items()
    }
    assert made["static_deflection"] == made["free_response_of_every_model"] == [True, True, True]
    assert made["energy_drift"] == [True, False, True]
    assert made["energy_decay"] == [False, True, False]


def test_what_only_moves_along_z_is_drawn_of_structures_whose_tip_does(structure):
    def shown(**changes):
        beam = structure.model_copy(update=changes)
        of_z = ("figure_03", "static_deflection", "reduced_against_full")
        return [name for name in of_z if FIGURES[name].shows(beam)]

    assert shown() == ["figure_03", "static_deflection", "reduced_against_full"]
    assert shown(joints=("torsion",)) == shown(joints=("torsion", "axial")) == []
    assert shown(joints=("in_plane",)) == ["figure_03"]
    assert shown(joints=("in_plane",), clamp_phi_deg=90.0) == shown()


@pytest.mark.parametrize(
    ("joints", "scales", "label"),
    [
        (("out_of_plane",), {}, "tip z [m]"),
        (("in_plane",), {"tip_z_m": 0.0, "tip_y_m": 40.0}, "tip y [m]"),
        (("axial",), {"tip_z_m": 0.0, "tip_y_m": 0.0}, "tip x [m]"),
        (("torsion",), {"tip_z_m": 0.0, "tip_y_m": 0.0, "tip_x_m": 0.0}, "tip twist [deg]"),
    ],
)
@pytest.mark.parametrize("name", ["free_response_of_every_model", "forced_response_of_every_model"])
def test_the_response_is_drawn_along_what_moves(name, joints, scales, label, structure, free):
    for column, scale in scales.items():
        free[column] *= scale
    figure = DRAW[name](structure.model_copy(update={"joints": joints}), free)
    shown = [ax for ax in figure.axes if ax.get_subplotspec().is_first_row()]
    assert figure.axes[0].get_ylabel() == label
    assert all(np.ptp(line.get_ydata()) > 0.01 for ax in shown for line in ax.lines[:2])


@pytest.mark.parametrize("joints", [("out_of_plane",), ("torsion",), ("axial",), ("in_plane", "torsion")])
def test_frames_are_turned_by_the_joints_that_there_are(joints, structure):
    beam = structure.model_copy(update={"joints": joints, **STIFF})
    figure = DRAW["figure_04"](beam)
    others = DRAW["figure_04"](beam.model_copy(update={"joints": ("out_of_plane", "torsion")}))
    assert outlines(figure) != outlines(others)


STIFF = {
    "bending_stiffness_in_plane_N_m2": 50.0,
    "torsional_stiffness_N_m2": 50.0,
    "axial_stiffness_N": 50.0,
    "torsional_inertia_per_length_kg_m": 0.1,
}


def outlines(figure):
    return [patch.get_xy().round(6).tolist() for patch in figure.axes[0].patches if hasattr(patch, "get_xy")]


def test_numbers_are_those_of_the_papers_structures_alone(structure):
    def numbered(name):
        beam = structure.model_copy(update={"name": name})
        shown = {figure for figure, product in OF_BEAMS.items() if product.shows(beam)}
        return {int(figure.removeprefix("figure_")) for figure in shown if figure.startswith("figure_")}

    results = {8, 9, 10, 12, 13, 14, 15}
    assert numbered("cantilever") & results == {8, 9, 10, 12, 13}
    assert numbered("wing") & results == {14, 15}
    assert not numbered("rod") & results


def names_in(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


@pytest.mark.parametrize(
    ("name", "networks"),
    [(name, ["HNN", "MLP"]) for name in ("figure_10", "figure_12", "figure_13")]
    + [(name, ["D-HNN", "MLP"]) for name in ("figure_14", "figure_15")],
)
def test_the_papers_curves_are_drawn_and_its_own_networks_where_there_are_any(name, networks, request):
    (frame,) = read_by(name, request)
    frame["model"] = frame["model"].replace({"polynomial": "dissipative_hnn"})
    own = frame[frame["model"] == "mlp"].assign(model="mlp_paper")
    for shown, mlp in ((frame, "MLP"), (pd.concat([frame, own]), "MLP (paper)")):
        found = set(names_in(DRAW[name](shown))) - {"load acts"}
        assert found == {"reduced order", networks[0], mlp}


def span(ax):
    """The longest line's first and last abscissa."""
    return ax.dataLim.x0, ax.dataLim.x1


@pytest.mark.parametrize(("name", "panels"), [("figure_09", 4), ("figure_10", 4), ("figure_12", 4)])
def test_the_cantilevers_windows_are_the_papers(name, panels, request):
    (frame,) = read_by(name, request)
    figure = DRAW[name](frame)
    longest_s = min(2.0, frame["t_s"].max())
    assert [span(ax) for ax in figure.axes] == [pytest.approx((0.0, longest_s))] * panels


@pytest.mark.parametrize("name", ["figure_14", "figure_15"])
def test_the_wings_panels_are_position_and_twist(name, request):
    figure = draw(name, request)
    labels = [ax.get_ylabel() for ax in figure.axes if ax.get_subplotspec().is_first_col()]
    assert labels == ["tip x [m]", "tip y [m]", "tip z [m]", "tip twist [deg]"]


@pytest.mark.parametrize("name", ["figure_12", "figure_13", "figure_15"])
def test_where_the_load_acts_is_shaded(name, request):
    figure = draw(name, request)
    assert "load acts" in names_in(figure)
    assert all(ax.patches for ax in figure.axes)


def test_a_load_without_an_end_is_shaded_as_far_as_there_are_curves(structure, sustained):
    endless = sustained.assign(load_end_s=np.inf)
    for ax in DRAW["figure_12"](endless).axes:
        (shaded,) = ax.patches
        assert shaded.get_x() + shaded.get_width() == pytest.approx(ax.dataLim.x1)
    every = DRAW["forced_response_of_every_model"](structure, endless)
    assert "first oscillations" in every.axes[0].get_title(loc="left")


def test_a_model_that_leaves_does_not_set_the_scale(request):
    response = request.getfixturevalue("free")
    response.loc[response["model"] == "hnn", ["tip_z_m", "tip_twist_rad"]] *= 1e3
    figure = DRAW["figure_14"](response)
    assert figure.axes[0].get_ylim()[1] < 1.0


def test_runs_without_an_end_stand_on_the_line_and_failed_ones_nowhere(request):
    figure = DRAW["architecture_errors"](request.getfixturevalue("relatives"))
    heights = [line.get_ydata()[0] for line in figure.axes[0].lines]
    # the line itself and the one run that did not end
    assert heights.count(1e3) == 2
    assert len(heights) == 6


def test_the_rule_of_choice_is_drawn_and_the_run_that_it_chooses(request):
    figure = draw("pareto", request)
    (ax, _) = figure.axes
    (ring,) = [line for line in ax.lines if line.get_markersize() == 9]
    # of the polynomial and the network that err by less than 0.5 %, the one that takes less
    assert ring.get_xdata().tolist() == [30.0]
    assert any(list(line.get_ydata()) == [0.5, 0.5] for line in ax.lines)
    assert {900.0, 6000.0} <= {line.get_xdata()[0] for line in ax.lines}
    names = {text.get_text() for text in figure.legends[0].get_texts()}
    assert {"chosen", "0.5 %: the rule of choice", "HNN", "polynomial H"} <= names


def test_without_a_limit_the_most_accurate_is_chosen(metrics):
    costly = metrics.assign(
        operations=metrics["operations"].where(metrics["architecture"] != "polynomial", 999)
    )
    figure = DRAW["pareto"]({"error_at_most_percent": None}, None, costly)
    (ring,) = [line for line in figure.axes[0].lines if line.get_markersize() == 9]
    assert ring.get_ydata().tolist() == [1e-3]


def test_maps_are_shown_by_their_validation(metrics):
    maps = metrics.assign(variant="sobol", architecture="network").drop(
        columns=["long_response_error_percent_worst", "diverged", "rom_operations", "fom_operations"]
    )
    lattice = {"vlm_rebuild": 45_000_000, "vlm_frozen": 3_000_000}
    figure = DRAW["pareto"]({"nmse_at_most": 1e-5}, lattice, maps)
    (ax,) = figure.axes
    assert ax.get_ylabel() == "validation nmse [–]"
    assert {*lattice.values()} <= {line.get_xdata()[0] for line in ax.lines}
    (ring,) = [line for line in ax.lines if line.get_markersize() == 9]
    assert ring.get_xdata().tolist() == [30.0]
    assert "1e-5: the rule of choice" in {text.get_text() for text in figure.legends[0].get_texts()}


def test_polynomials_and_networks_have_markers_of_their_own_and_no_two_labels_are_alike(metrics):
    settings = {"architecture": "port_hamiltonian", "variant": "hamiltonian", "optimiser": "least_squares"}
    polynomials = metrics[metrics["architecture"] == "polynomial"].tail(1).assign(**settings, terms="all")
    again = polynomials.assign(
        run_id="again", operations=40, long_response_error_percent_worst=1e-4, dataset="many"
    )
    sparse = again.assign(
        run_id="sparse", operations=50, long_response_error_percent_worst=1e-5, terms="sparse"
    )
    network = polynomials.assign(
        run_id="network", operations=60, degree=None, hidden="8", mass_matrix="entries", optimiser="lbfgs"
    )
    figure = DRAW["pareto"]({}, None, pd.concat([polynomials, again, sparse, network]))
    markers = [line.get_marker() for line in figure.axes[0].lines]
    assert {"s", "o"} <= {*markers}
    words = [text.get_text() for text in figure.axes[0].texts]
    assert len({*words}) == len(words)
    assert "port-Hamiltonian degree 6, many" in words
    assert "port-Hamiltonian degree 6 sparse" in words
    assert any(word.endswith("entries") for word in words)
    legend = {text.get_text() for text in figure.legends[0].get_texts()}
    assert {"port-Hamiltonian, polynomial", "port-Hamiltonian, network"} <= legend


def test_a_study_without_a_finished_run_is_drawn(metrics):
    figure = DRAW["pareto"]({}, None, metrics.assign(status="failed"))
    assert len(figure.axes) == 2
