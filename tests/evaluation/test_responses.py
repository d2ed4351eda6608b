"""Responses side by side, and the errors by which surrogates are chosen."""

import numpy as np
import pytest

from flexsurr.evaluation.operations import operations
from flexsurr.evaluation.responses import (
    RESPONSE_COLUMNS,
    response_table,
)
from flexsurr.evaluation.scores import long_response_errors, long_responses
from flexsurr.evaluation.validation import INTERVALS, VALIDATION_COLUMNS, validation_table
from flexsurr.surrogates import compiled


@pytest.mark.parametrize("response", ["free", "forced"])
def test_a_surrogate_equal_to_the_reference_follows_it(response, study, basis, fitted):
    table = response_table(study, basis, "hamiltonian", response, {"polynomial": fitted})
    worst = table.groupby("model")["tip_error_percent"].max()
    assert worst["reference"] == 0.0
    assert worst["polynomial"] < 1e-3
    assert list(table.columns) == list(RESPONSE_COLUMNS)


def test_a_sustained_load_acts_as_long_as_it_may(study, basis, fitted):
    table = response_table(study, basis, "hamiltonian", "sustained", {"polynomial": fitted})
    assert set(table["load_end_s"]) == {study.evaluation.longest_load_s}
    assert table.groupby("model")["tip_z_m"].apply(lambda z: z.abs().max()).gt(0.01).all()
    assert table["tip_error_percent"].max() < 1e-3


def test_the_force_moves_the_tip_from_rest(study, basis, fitted):
    table = response_table(study, basis, "hamiltonian", "forced", {"polynomial": fitted})
    polynomial = table[table["model"] == "polynomial"]
    assert polynomial["tip_z_m"].iloc[0] == pytest.approx(0.0, abs=1e-12)
    assert polynomial["tip_z_m"].abs().max() > 0.01
    assert 0.0 < polynomial["load_end_s"].iloc[0] <= study.evaluation.longest_load_s


def test_a_response_that_explodes_ends_its_rows(study, basis, exploding):
    table = response_table(study, basis, "hamiltonian", "free", {"polynomial": exploding})
    end = table.groupby("model")["t_s"].max()
    assert end["polynomial"] < end["reference"] == pytest.approx(study.evaluation.duration_s)
    assert table.notna().all(axis=None)


def errors_of(study, basis, variant, surrogate):
    return long_response_errors(study, basis, variant, surrogate, long_responses(study, basis, variant))


def test_an_exact_surrogate_has_next_to_no_long_response_error(study, basis, fitted):
    errors = errors_of(study, basis, "hamiltonian", fitted)
    assert errors["diverged"] == 0
    assert errors["long_response_error_percent_median"] <= errors["long_response_error_percent_worst"] < 1e-3
    assert errors["energy_drift_percent"] < 1e-3


def test_on_the_printed_field_the_same_surrogate_errs(study, basis, fitted):
    errors = errors_of(study, basis, "as_printed", fitted)
    assert errors["long_response_error_percent_worst"] > 0.1


def test_an_exploding_surrogate_diverges_and_claims_nothing(study, basis, exploding):
    errors = errors_of(study, basis, "hamiltonian", exploding)
    assert errors == {
        "long_response_error_percent_worst": None,
        "long_response_error_percent_median": None,
        "energy_drift_percent": None,
        "diverged": study.evaluation.long_responses,
        "operations": operations(compiled(exploding), np.zeros(2)),
    }


def test_full_and_reduced_order_respond_alike_and_the_dropped_term_shows(study, basis):
    table = validation_table(study, basis)
    assert list(table.columns) == list(VALIDATION_COLUMNS)
    z = table.pivot_table(index="t_s", columns=["variant", "model"], values="tip_z_m")
    assert z.notna().all(axis=None)
    assert z.index.size == INTERVALS + 1
    assert z.index.max() == study.evaluation.validation_duration_s
    peak = z.abs().max().max()
    reduction = (z["hamiltonian", "fom"] - z["hamiltonian", "rom"]).abs().max()
    dropping = (z["hamiltonian", "rom"] - z["as_printed", "rom"]).abs().max()
    assert reduction < 0.02 * peak < dropping
