"""The columns of the tables are a contract; the files are atomic and complete."""

import pandas as pd
import pytest

from flexsurr.report.catalogue import TABLES
from flexsurr.report.cost_figures import pareto_front
from flexsurr.report.pages import save_page
from flexsurr.report.tables import TABULATE, save_table

CONTRACT = {
    "static_tip": "load_N, x_exact_m, z_exact_m, x_fom_m, z_fom_m, x_rom_m, z_rom_m",
    "natural_frequencies": "structure, mode, fom_rad_s, rom_rad_s, published_fom_rad_s, published_rom_rad_s",
    "training": "study, variant, run_id, architecture, configurations, hidden, activation, degree, "
    "terms, options, scaling, samples_per_trajectory, potential, mass_matrix, optimiser, learning_rate, "
    "weight_decay, batch_size, precision, device, loss, keep, patience, time_limit_s, give_up, seed, "
    "dataset, status, reason, epoch_limit, epochs, best_epoch, "
    "wall_s, processor_s, parameters, final_loss, train_nmse, validation_nmse, best_validation_nmse, "
    "published_loss, sampling, lattice, networks, inputs",
    "sweeps": "study, sweep, variant, architecture, trials, finished, stopped, failed, processor_s, "
    "validation_nmse_median, validation_nmse_best, long_response_error_percent_best, best_run_id, outcome",
    "seeds": "study, variant, configuration, architecture, hidden, activation, degree, optimiser, seeds, "
    "failed, wall_s_mean, wall_s_std, validation_nmse_mean, validation_nmse_std_decades, "
    "long_response_error_percent_mean, long_response_error_percent_std, diverged",
    "architectures": "study, variant, architecture, normalisation, scaling, dataset, hidden, activation, "
    "degree, mass_matrix, optimiser, seed, run_id, status, parameters, wall_s, train_nmse, validation_nmse, "
    "held_out_nmse, long_response_error_percent_median, long_response_error_percent_worst, diverged, "
    "held_out_nmse_eta_1, held_out_nmse_p_1",
    "cost": "study, variant, response, model, implementation, integrator, simulations, wall_s_mean, "
    "wall_s_std, relative_to_described_percent, relative_to_described_std_percent, "
    "relative_to_numpy_percent, relative_to_compiled_percent, paper_percent, paper_std_percent, "
    "tip_error_percent, energy_drift_percent, diverged",
    "learned_loads": "study, variant, map, form, parameters, tip_rms_over_length, twist_largest_error_rad, "
    "force_relative_error",
}


@pytest.fixture
def tabulate(sweeps):
    """What makes a table of one frame; of sweeps it takes their runs too."""

    def made(name, frame):
        known = [sweeps] if "sweeps" in TABLES[name].reads else []
        return TABULATE[name](*known, frame)

    return made


@pytest.fixture
def frames(statics, metrics, cost, relatives):
    frequencies = pd.DataFrame(
        {
            "structure": ["wing"] * 2,
            "mode": [1, 2],
            "fom_rad_s": [2.2, 9.5],
            "rom_rad_s": [2.2, None],
            "published_fom_rad_s": [2.21, 9.55],
            "published_rom_rad_s": [2.21, 9.59],
            "exact_rad_s": [None, None],
        }
    )
    learned_loads = pd.DataFrame(
        {
            "study": ["wing"] * 2,
            "variant": ["hamiltonian"] * 2,
            "map": ["kinematics", "network"],
            "form": ["degree 8", "16 half_log"],
            "parameters": [4000, 115],
            "tip_rms_over_length": [1e-7, None],
            "twist_largest_error_rad": [1e-5, None],
            "force_relative_error": [1e-5, 1e-4],
        }
    )
    return {
        "learned_loads": learned_loads,
        "static_tip": statics,
        "natural_frequencies": frequencies,
        "training": metrics,
        "sweeps": metrics,
        "architectures": relatives,
        "seeds": metrics,
        "cost": cost,
    }


def test_every_table_of_the_catalogue_is_made_and_no_other():
    assert set(TABULATE) == set(TABLES)
    assert set(CONTRACT) == {name for name, table in TABLES.items() if "trajectories" in table.sources}


@pytest.mark.parametrize("name", CONTRACT)
def test_columns_are_those_of_the_contract(name, frames, tabulate):
    # more columns in, shuffled: exactly the contract's out, in its order
    frame = frames[name].assign(surplus=1.0).iloc[:, ::-1]
    assert ", ".join(tabulate(name, frame).columns) == CONTRACT[name]


@pytest.mark.parametrize("name", CONTRACT)
def test_a_missing_column_is_named(name, frames, tabulate):
    column = next(column for column in CONTRACT[name].split(", ")[1:] if column in frames[name])
    with pytest.raises(KeyError, match=column):
        tabulate(name, frames[name].drop(columns=column))


@pytest.mark.parametrize("name", ["training", "architectures", "seeds", "sweeps"])
def test_where_no_trial_has_finished_tables_of_runs_have_all_of_them(name, relatives, metrics, sweeps):
    """`sweeps` has its own tests of what such a table says."""
    frame = metrics if name in ("training", "sweeps") else relatives.assign(configuration=relatives["run_id"])
    scored = [column for column in frame if column.startswith(("held_out", "long_response", "diverged"))]
    frame = frame.drop(columns=scored).assign(status="stopped", reason="hopeless", validation_nmse=None)
    made = TABULATE[name](*([sweeps] if name == "sweeps" else []), frame)
    assert made["trials"].sum() == sum(map(len, sweeps.values())) if name == "sweeps" else len(made) >= 8


def test_failed_runs_stay_in_the_table_of_training(frames):
    made = TABULATE["training"](frames["training"])
    assert len(made) == len(frames["training"])
    assert made["validation_nmse"].isna().sum() == 1


def rows_of(page):
    """How many rows the table of a page has below its head."""
    return page.partition("<tbody>")[2].partition("</tbody>")[0].count("<tr>")


@pytest.mark.parametrize("name", CONTRACT)
def test_csv_and_page_hold_every_row(name, frames, tabulate, tmp_path):
    made = tabulate(name, frames[name])
    save_table(made, tmp_path / "table.csv")
    save_page(made, "Title", "Caption", tmp_path / "table.html")
    back = pd.read_csv(tmp_path / "table.csv")
    assert list(back.columns) == list(made.columns)
    assert len(back) == len(made)
    for column in made.select_dtypes("number"):
        pd.testing.assert_series_equal(back[column], made[column], check_dtype=False, rtol=1e-8)
    assert rows_of((tmp_path / "table.html").read_text(encoding="utf-8")) == len(made)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["table.csv", "table.html"]


def test_nothing_beats_a_row_of_the_pareto_front(cost):
    panel = cost[(cost["variant"] == "hamiltonian") & (cost["response"] == "free")]
    front = pareto_front(panel)
    assert not front.empty
    for row in front.itertuples():
        better = (panel["wall_s_mean"] <= row.wall_s_mean) & (
            panel["tip_error_percent"] <= row.tip_error_percent
        )
        assert better.sum() == 1
    for row in panel.dropna(subset=["wall_s_mean", "tip_error_percent"]).itertuples():
        beaten_or_on_it = (front["wall_s_mean"] <= row.wall_s_mean) & (
            front["tip_error_percent"] <= row.tip_error_percent
        )
        assert beaten_or_on_it.any()


def test_failed_runs_stay_in_the_table_of_architectures(relatives):
    table = TABULATE["architectures"](relatives)
    assert len(table) == len(relatives)
    failed = table[table["status"] == "failed"].iloc[0]
    assert failed[["held_out_nmse", "held_out_nmse_eta_1"]].isna().all()
    finished = table[table["status"] == "finished"]
    assert (finished["held_out_nmse_p_1"] == 2.0 * finished["held_out_nmse_eta_1"]).all()
