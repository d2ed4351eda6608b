"""What a sweep came to: by which settings its trials differ, their table, and the figure of all of them."""

import numpy as np
import pandas as pd
import pytest

from flexsurr.config.sweep import FieldSweep
from flexsurr.config.trial import settings_of
from flexsurr.report.figures import DRAW
from flexsurr.report.run_tables import sweeps
from flexsurr.report.style import save
from flexsurr.report.trial_figures import WITHOUT
from flexsurr.report.trial_settings import in_words, settings_that_differ
from flexsurr.training import expand

ADAM = {
    "architecture": "hnn",
    "hidden": {"low": 4, "high": 64, "scale": "log"},
    "activation": ["silu", "atan"],
    "optimiser": ["adam"],
    "learning_rate": {"low": 1e-4, "high": 0.1, "scale": "log"},
    "batch_size": [32],
    "epochs": [50],
}
POLYNOMIALS = {"architecture": "polynomial", "degree": [2, 4, 6], "optimiser": ["least_squares"]}


def runs_of(*spaces, draws=40):
    """Metrics as training writes them, with made-up errors that grow with the number of the run."""
    rows = []
    for number, trial in enumerate(expand(FieldSweep(search="sobol", draws=draws, spaces=spaces))):
        settings = settings_of(trial)
        hidden = "x".join(map(str, settings["hidden"] or ()))
        made = {"run_id": f"run-{number}", "study": "beam", "variant": "hamiltonian", "dataset": "default"}
        made |= {"status": "finished", "reason": "", "processor_s": 2.0, "epoch_limit": settings["epochs"]}
        made |= {"hidden": hidden, "epochs": 3, "validation_nmse": 10.0 ** (number / 10.0 - 8.0)}
        rows.append({**settings, **made})
    return pd.DataFrame(rows)


def test_settings_are_those_that_tell_trials_apart():
    settings = settings_that_differ(runs_of(ADAM, POLYNOMIALS))
    assert list(settings) == ["architecture", "hidden", "activation", "degree", "learning_rate"]
    assert pd.api.types.is_numeric_dtype(settings["hidden"])
    assert in_words(settings.iloc[-1]) == "architecture polynomial, degree 6"


def test_of_one_architecture_only_what_varies_is_told():
    assert list(settings_that_differ(runs_of(POLYNOMIALS))) == ["architecture", "degree"]
    several = runs_of(ADAM | {"batch_size": [32, 64], "seed": [0, 1]})
    assert list(settings_that_differ(several)) == [
        "architecture",
        "hidden",
        "activation",
        "learning_rate",
        "seed",
        "batch_size",
    ]


def test_keywords_of_ones_own_network_are_settings():
    frame = runs_of(POLYNOMIALS).assign(options=["width=[8, 8], gain=2", "width=[8], gain=3", None])
    settings = settings_that_differ(frame)
    assert settings["option width"].tolist()[:2] == ["[8, 8]", "[8]"]
    assert settings["option gain"].tolist()[:2] == [2.0, 3.0]


def test_the_table_counts_each_way_to_end_and_names_the_best():
    metrics = runs_of(ADAM, POLYNOMIALS)
    metrics.loc[0, ["status", "reason"]] = ["stopped", "given up"]
    metrics.loc[1, ["status", "reason", "validation_nmse"]] = ["failed", "not finite", None]
    table = sweeps({"default": list(metrics["run_id"]), "few": ["run-5"]}, metrics)
    assert table["sweep"].tolist() == ["default", "default", "few"]
    networks = table.iloc[0]
    assert networks[["architecture", "trials", "finished", "stopped", "failed"]].tolist() == [
        "hnn",
        40,
        38,
        1,
        1,
    ]
    assert networks["processor_s"] == 80.0
    assert networks["best_run_id"] == "run-2"
    assert networks["validation_nmse_best"] == metrics["validation_nmse"][2]
    assert networks["outcome"] == in_words(settings_that_differ(metrics).iloc[2].drop("architecture"))
    assert table.iloc[1]["outcome"] == "degree 2"


@pytest.mark.parametrize(
    ("statuses", "said"),
    [
        (["failed"] * 3, "every trial failed; the first: because"),
        (["stopped"] * 3, "every trial was stopped; the first: because"),
        (["failed", "stopped", "failed"], "no trial finished; the first: because"),
    ],
)
def test_a_sweep_of_which_nothing_came_says_so(statuses, said):
    metrics = runs_of(POLYNOMIALS).assign(status=statuses, reason="because", validation_nmse=None)
    runs = {"default": list(metrics["run_id"])}
    (row,) = sweeps(runs, metrics).to_dict("records")
    assert (row["trials"], row["finished"], row["outcome"]) == (3, 0, said)
    assert row["best_run_id"] is None
    (ax,) = DRAW["trials"](runs, metrics).axes
    assert len(lines_of(ax, metrics)) == 3
    assert {line.get_ydata()[-1] for line in lines_of(ax, metrics)} == {WITHOUT}


def lines_of(ax, metrics):
    """The lines of trials, from the worst to the best: they alone go through more than two axes, or all."""
    return [line for line in ax.lines if list(line.get_xdata()) == list(range(len(line.get_xdata())))]


@pytest.mark.parametrize(("spaces", "draws"), [((ADAM, POLYNOMIALS), 57), ((ADAM,), 6)])
def test_every_trial_is_a_line_the_best_on_top_and_thickest(spaces, draws):
    metrics = runs_of(*spaces, draws=draws)
    metrics.loc[3, ["status", "validation_nmse"]] = ["failed", None]
    (ax,) = DRAW["trials"]({"default": list(metrics["run_id"])}, metrics).axes
    lines = lines_of(ax, metrics)
    assert len(lines) == len(metrics)
    *others, best = sorted(lines, key=lambda line: line.get_zorder())
    assert best.get_linewidth() > max(line.get_linewidth() for line in others)
    ends = [line.get_ydata()[-1] for line in lines if line.get_ydata()[-1] != WITHOUT]
    assert best.get_ydata()[-1] == min(ends) == 0.0
    assert max(ends) == 1.0
    assert len(ends) == len(metrics) - 1


def test_a_figure_of_thousands_of_trials_is_no_larger_than_one_of_hundreds(tmp_path):
    sizes = []
    for draws in (450, 1000):
        metrics = runs_of(ADAM, draws=draws).assign(validation_nmse=np.geomspace(1e-8, 1.0, draws))
        svg, _ = save(DRAW["trials"]({"default": list(metrics["run_id"])}, metrics), tmp_path / str(draws))
        sizes.append(svg.stat().st_size)
    assert sizes[1] < 2 * sizes[0]


def test_numbers_that_are_many_stand_by_their_logarithm():
    metrics = runs_of(ADAM)
    (ax,) = DRAW["trials"]({"default": list(metrics["run_id"])}, metrics).axes
    place = list(settings_that_differ(metrics)).index("learning_rate")
    heights = {round(float(line.get_ydata()[place]), 9) for line in lines_of(ax, metrics)}
    rates = np.log10(metrics["learning_rate"])
    expected = (rates - rates.min()) / (rates.max() - rates.min())
    assert heights == {round(height, 9) for height in expected}


def test_what_was_never_taken_has_a_place_of_its_own():
    metrics = runs_of(ADAM, POLYNOMIALS)
    (ax,) = DRAW["trials"]({"default": list(metrics["run_id"])}, metrics).axes
    place = list(settings_that_differ(metrics)).index("learning_rate")
    at_zero = [line for line in lines_of(ax, metrics) if line.get_ydata()[place] == 0.0]
    assert len(at_zero) == 3
    assert min(line.get_ydata()[place] for line in lines_of(ax, metrics) if line not in at_zero) > 0.1


def test_each_variant_has_a_panel_and_each_sweep_an_axis():
    metrics = pd.concat([runs_of(POLYNOMIALS), runs_of(POLYNOMIALS).assign(variant="as_printed")])
    metrics["run_id"] = [f"run-{number}" for number in range(6)]
    metrics = metrics.reset_index(drop=True)
    figure = DRAW["trials"](
        {"default": ["run-0", "run-1", "run-3"], "many": ["run-2", "run-4", "run-5"]}, metrics
    )
    assert len(figure.axes) == 2
    for ax in figure.axes:
        assert {"sweep", "architecture", "degree"} <= {text.get_text() for text in ax.texts}
