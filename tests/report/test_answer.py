"""The answer: which surrogates pay, by how much, and at what loss."""

import numpy as np
import pandas as pd
import pytest

from flexsurr.report.answer import ANSWER_COLUMNS, answer, in_words
from flexsurr.report.answer_figure import answer_figure
from flexsurr.report.style import save

CASE = {"study": "beam", "response": "free", "variant": "hamiltonian", "implementation": "compiled"}


def cost_of(*setups, **case):
    """Rows of cost.csv: model, integrator, wall time and error of each setup."""
    names = ("model", "integrator", "wall_s_mean", "tip_error_percent", "diverged")
    return pd.DataFrame([CASE | dict(zip(names, (*setup, 0), strict=False)) | case for setup in setups])


BEAM = cost_of(
    ("rom", "fast", 1.0, 5.0),
    ("rom", "fine", 2.0, 0.5),
    ("hnn", "fast", 0.4, 3.0),
    ("hnn", "fine", 0.8, 0.9),
    ("mlp", "fast", 0.1, 40.0),
    ("mlp", "fine", 0.2, 30.0),
    ("mlp", "slow", 9.0, 29.0),
    ("polynomial", "fine", 2.5, 1e-5),
)
SLOW = pd.concat(
    [
        cost_of(("rom", "scipy", 2000.0, 9.0), implementation="described"),
        cost_of(("rom", "scipy", 80.0, 9.0), ("hnn", "scipy", 8.0, 9.0), implementation="numpy"),
        cost_of(("hnn", "scipy", 90.0, 9.0), implementation="torch"),
    ]
)


def test_machine_code_is_compared_with_machine_code_of_the_same_accuracy():
    table = answer(pd.concat([BEAM, SLOW]))
    assert tuple(table.columns) == ANSWER_COLUMNS
    assert table["model"].tolist() == ["hnn", "mlp", "polynomial"]
    assert table["pays"].tolist() == ["yes", "no", "no"]
    # not the reduced model of 1 s, which errs by 5 %
    assert set(table["reference_wall_s"]) == {2.0}
    np.testing.assert_allclose(table["times_as_fast"], [2.5, 10.0, 0.8])
    np.testing.assert_allclose(table["times_as_fast_as_numpy"], [100.0, 400.0, 32.0])
    np.testing.assert_allclose(table["times_as_fast_as_described"], [2500.0, 10000.0, 800.0])


def test_what_errs_too_much_stands_with_its_least_error():
    (mlp,) = answer(BEAM).query("model == 'mlp'").to_dict("records")
    assert (mlp["integrator"], mlp["tip_error_percent"], mlp["pays"]) == ("fine", 30.0, "no")


def test_what_diverged_does_not_pay_and_what_has_no_time_is_left_out():
    table = answer(
        pd.concat([BEAM, cost_of(("hnn_paper", "fine", 0.1, 0.1, 1), ("own", "fine", None, None, 3))])
    )
    assert table.set_index("model")["pays"].to_dict()["hnn_paper"] == "no"
    assert "own" not in set(table["model"])


def test_the_lattice_itself_has_no_error_and_rebuilt_it_is_the_described_baseline():
    air = {"study": "airliner", "response": "manoeuvre", "variant": "linear"}
    setups = [("vlm_rebuild", 8.0, 0.01), ("vlm_frozen", 1.0, None), ("network", 0.1, 0.2)]
    table = answer(cost_of(*[(model, "rk4", wall, error) for model, wall, error in setups], **air))
    (row,) = table.to_dict("records")
    assert (row["model"], row["reference"], row["pays"]) == ("network", "vlm_frozen", "yes")
    assert row["times_as_fast"] == pytest.approx(10.0)
    assert row["times_as_fast_as_described"] == pytest.approx(80.0)
    assert np.isnan(row["times_as_fast_as_numpy"])


def test_cases_keep_their_order_and_stand_apart():
    forced = BEAM.assign(response="forced")
    table = answer(
        pd.concat([BEAM, forced, BEAM.assign(study="another"), forced.assign(variant="as_printed")])
    )
    cases = list(dict.fromkeys(zip(table["study"], table["response"], table["variant"], strict=True)))
    assert cases == [
        ("beam", "free", "hamiltonian"),
        ("beam", "forced", "hamiltonian"),
        ("beam", "forced", "as_printed"),
        ("another", "free", "hamiltonian"),
    ]


def test_in_words_it_names_the_fastest_that_is_accurate_enough():
    beam, other = in_words(answer(pd.concat([BEAM, SLOW, BEAM.query("model != 'hnn'").assign(study="slow")])))
    assert beam == (
        "beam: a surrogate pays in 1 of 1 cases. The fastest within 1 %, HNN, is 2.5 times as fast as the "
        "compiled reference, reduced order, and 2,500 times as fast as the described baseline at a loss of "
        "0.9 % (free, gyroscopic term kept)."
    )
    assert other.startswith("slow: no surrogate pays. The fastest within 1 %, polynomial H, is 0.8 times as")
    (none,) = in_words(answer(BEAM.query("model in ('rom', 'mlp')")))
    assert none == (
        "beam: no surrogate stays within 1 % of the peak. The one that errs least, MLP, does so by 30 %, and "
        "is 10 times as fast as the compiled reference, reduced order."
    )


def test_a_missing_column_is_named():
    with pytest.raises(KeyError, match="tip_error_percent"):
        answer(BEAM.drop(columns="tip_error_percent"))


@pytest.mark.parametrize("cost", [BEAM, BEAM.query("model in ('rom', 'mlp')"), BEAM.query("model == 'rom'")])
def test_the_figure_has_a_point_a_row_and_names_the_best(cost, tmp_path):
    table = answer(cost)
    figure = answer_figure(table)
    (ax,) = figure.axes
    points = [line for line in ax.lines if line.get_marker() not in ("None", None, "")]
    assert len(points) == len(table)
    named = [text.get_text() for text in ax.texts if "×" in text.get_text()]
    assert named == (["HNN\nfree: 2.5×"] if "hnn" in set(table["model"]) else [])
    save(figure, tmp_path / "answer")


def test_it_answers_what_evaluation_writes(cost):
    """The fixture has the columns of cost.csv, two variants and two responses."""
    table = answer(cost)
    assert len(table.groupby(["response", "variant"])) == 4
    assert (table["pays"] == "yes").any()
    assert len(answer_figure(table).axes) == 1
