"""Energy drift: of what conserves it, none; of what does not, as much as it says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexsurr.beam import reduce
from flexsurr.evaluation.cases import Case, ReferenceSolution, energy_above_rest, rest_state
from flexsurr.evaluation.energy import (
    ENERGY_COLUMNS,
    drift_percent,
    energy_error_percent,
    energy_table,
    relative_drift_percent,
)


@given(st.floats(1e-3, 1e3), st.floats(-50.0, 50.0))
def test_a_linear_loss_drifts_by_its_share(energy, percent):
    t = np.linspace(0.0, 1.0, 11)
    lost = energy * (1.0 + 0.01 * percent * t)
    assert relative_drift_percent(lost)[-1] == pytest.approx(abs(percent), abs=1e-9)
    assert drift_percent(lost, t) == pytest.approx(abs(percent), abs=1e-9)


def test_work_of_the_load_is_no_drift():
    t = np.linspace(0.0, 1.0, 101)
    energy = np.where(t < 0.5, 10.0 * t, 5.0)
    assert drift_percent(energy, t, free_from_s=0.5) == 0.0
    assert drift_percent(energy + 0.5 * (t > 0.7), t, free_from_s=0.5) == pytest.approx(10.0)


def test_nothing_after_the_load_is_nothing_to_compare():
    t = np.linspace(0.0, 1.0, 11)
    assert np.isnan(drift_percent(np.ones(11), t, free_from_s=2.0))


def test_where_something_dissipates_the_distance_from_the_reference_counts(structure):
    """An energy that falls as the reference's does has no error, one that is conserved has a large one."""
    t = np.linspace(0.0, 1.0, 11)
    falling = 8.0 * np.exp(-t)
    reference = ReferenceSolution(Case(0, np.zeros(2)), t, np.zeros((11, 2)), np.zeros((11, 3)), falling, 1.0)
    damped = structure.model_copy(update={"damping_out_of_plane_s": 0.1})
    assert energy_error_percent(damped, reference, falling, 0.0) == 0.0
    assert energy_error_percent(damped, reference, np.full(11, 8.0), 0.0) == pytest.approx(63.2, abs=0.1)
    assert energy_error_percent(damped, reference, falling[:4] + 0.8, 0.0) == pytest.approx(10.0)
    assert energy_error_percent(structure, reference, np.full(11, 8.0), 0.0) == 0.0
    assert energy_error_percent(structure, reference, falling, 0.0) == pytest.approx(63.2, abs=0.1)


@pytest.mark.parametrize("gravity_m_s2", [0.0, 9.81])
@pytest.mark.parametrize("variant", ["hamiltonian", "as_printed"])
def test_energy_is_above_that_of_rest_which_under_gravity_is_not_the_undeformed_shapes(
    structure, study, variant, gravity_m_s2
):
    basis = reduce(structure.model_copy(update={"gravity_m_s2": gravity_m_s2}), study.reduction)
    at_rest = rest_state(basis)
    near = at_rest + np.array([[1e-3, 0.0], [-1e-3, 0.0], [0.0, 1e-3], [0.0, -1e-3]])
    assert energy_above_rest(basis, variant, at_rest[None]) == pytest.approx([0.0], abs=1e-12)
    assert energy_above_rest(basis, variant, near).min() > 0.0
    undeformed = energy_above_rest(basis, variant, np.zeros((1, 2)))
    assert (undeformed[0] > 1e-6) == (gravity_m_s2 > 0.0)


@pytest.fixture(scope="module")
def table(study, basis, fitted):
    return energy_table(study, basis, "hamiltonian", {"polynomial": fitted})


def test_the_run_of_the_exact_field_does_not_drift(table):
    rows = (table["panel"] == "models") & (table["model"] == "rom") & (table["response"] == "free")
    models = table[rows]
    assert models["integrator"].nunique() == 1
    assert models["drift_percent"].max() < 1e-5


def test_an_exact_surrogate_conserves_the_references_energy(table):
    rows = (table["panel"] == "models") & (table["model"] == "polynomial") & (table["response"] == "free")
    assert table[rows]["drift_percent"].max() < 1e-5


def test_energy_comes_from_the_load_alone(table):
    forced = table[(table["response"] == "forced") & (table["model"] == "rom")]
    assert set(forced["panel"]) == {"models"}
    after = forced[forced["t_s"] > forced["load_end_s"]]
    assert forced["energy_J"].iloc[0] == 0.0
    assert after["energy_J"].min() > 0.0
    assert after["energy_J"].max() - after["energy_J"].min() < 1e-4 * after["energy_J"].max()


def test_every_integrator_is_shown_and_scipys_defaults_drift_most(table, study):
    worst = table[table["panel"] == "integrators"].groupby("integrator")["drift_percent"].max()
    assert {integrator.label for integrator in study.evaluation.integrators} < set(worst.index)
    assert worst["scipy_radau"] > 100.0 * worst["rk4(h=0.0002)"]
    assert list(table.columns) == list(ENERGY_COLUMNS)


def test_the_printed_field_has_no_energy_to_conserve(study, basis, fitted):
    table = energy_table(study, basis, "as_printed", {})
    rom = table[(table["panel"] == "models") & (table["model"] == "rom") & (table["response"] == "free")]
    assert 0.01 < rom["drift_percent"].max() < 10.0
