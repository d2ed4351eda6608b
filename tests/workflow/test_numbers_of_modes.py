"""A study of several numbers of modes from end to end: trained, scored, timed, tabulated and drawn."""

import json

import pandas as pd
import pytest

from flexsurr.evaluation.columns import CROSSOVER_COLUMNS

STUDY = "crossover"
MODELS = {"rom", "polynomial_2", "polynomial_2_sparse", "network_4_atan", "network_4_atan_mirrored"}


@pytest.fixture(scope="module")
def made(make_project):
    """That of the quick preset, whose integrators need no compiling."""
    project = make_project()
    project.tell_no_page()
    project.change("config/presets/quick.yaml", "studies", [STUDY])
    project.run_well()
    return project


def test_every_run_stands_beside_the_reduced_model(made):
    table = pd.read_csv(made.results / "tables" / "crossover.csv")
    assert tuple(table.columns) == CROSSOVER_COLUMNS
    for _, of_modes in table.groupby("modes"):
        assert set(of_modes["model"]) == MODELS
        by_model = of_modes.set_index("model")
        assert by_model.loc["rom", "relative_to_compiled_percent"] == 100.0
        assert by_model.loc["rom", "tip_error_percent"] < 1.0
        assert (by_model["tip_error_percent"] < 5.0).all()
        assert (by_model["wall_s"] > 0.0).all()
        rivals = by_model.drop(index="rom")
        assert (rivals["parameters"] > 0).all()
        assert set(rivals["run_id"]) == set(
            made.plan.studies[STUDY].plans[str(of_modes["modes"].iloc[0])].runs
        )


def test_runs_are_scored_without_a_dataset(made):
    for key in made.plan.runs:
        metrics = json.loads((made.results / "runs" / key / "metrics.json").read_text())
        assert metrics["status"] == "finished"
        assert metrics["long_response_error_percent_worst"] > 0.0
        assert "held_out_nmse" not in metrics
    assert not (made.results / "datasets").exists()


def test_the_figure_and_the_page_are_there_and_nothing_is_left_to_do(made):
    assert (made.results / "figures" / STUDY / "crossover.png").read_bytes().startswith(b"\x89PNG")
    assert "What stands for" in (made.results / "tables" / STUDY / "crossover.html").read_text()
    assert made.scheduled() == {}
