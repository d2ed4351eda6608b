"""What stands for a reduced model, beside it: every run by its name, judged by the same responses."""

import pytest

from flexsurr.evaluation.columns import CROSSOVER_COLUMNS
from flexsurr.evaluation.rivals import Rival, name_of, rivals_table


@pytest.fixture(scope="module")
def table(study, basis, fitted, exploding):
    rivals = [Rival("run-1", "polynomial_10", fitted), Rival("run-2", "polynomial_4", exploding)]
    return rivals_table(study, basis, "hamiltonian", rivals)


def test_each_has_its_row_after_the_reduced_model(table, fitted):
    assert tuple(table.columns) == CROSSOVER_COLUMNS
    assert table["model"].tolist() == ["rom", "polynomial_10", "polynomial_4"]
    assert table["run_id"].tolist() == ["", "run-1", "run-2"]
    assert table["parameters"].isna().tolist() == [True, False, False]
    assert table["parameters"].iloc[1] == len(fitted.parameters)
    assert set(table["modes"]) == {1}
    assert table["operations"].iloc[0] > table["operations"].iloc[1] > 0


def test_all_are_stepped_alike_and_judged_by_the_reference(table):
    rom, good, bad = table.to_dict("records")
    assert rom["relative_to_compiled_percent"] == 100.0
    assert rom["tip_error_percent"] < 1e-2  # the integrator's own
    assert good["tip_error_percent"] < 1e-2
    assert good["relative_to_compiled_percent"] > 0.0
    assert (rom["diverged"], good["diverged"], bad["diverged"]) == (0, 0, 3)
    assert bad["wall_s"] != bad["wall_s"]  # of no response that reached its end


@pytest.mark.parametrize(
    ("run", "name"),
    [
        ({"degree": 4, "terms": "all", "mass_matrix": None}, "polynomial_4"),
        ({"degree": 6, "terms": "sparse"}, "polynomial_6_sparse"),
        ({"degree": None, "hidden": "64", "activation": "atan", "mass_matrix": "entries"}, "network_64_atan"),
        ({"hidden": "8", "activation": "tanh", "mass_matrix": "mirrored"}, "network_8_tanh_mirrored"),
        ({"hidden": "8", "activation": "tanh", "mass_matrix": "factored"}, "network_8_tanh_factored"),
    ],
)
def test_a_run_is_named_by_what_sets_it_apart(run, name):
    assert name_of(run) == name
