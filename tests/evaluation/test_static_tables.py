"""Static tip positions and natural frequencies against closed forms and published values."""

import numpy as np
import pytest

from flexsurr.beam import reduce
from flexsurr.config.study import Statics
from flexsurr.evaluation.published import FREQUENCIES_RAD_S
from flexsurr.evaluation.statics import natural_frequencies, static_tip


def test_unloaded_the_beam_is_straight_and_loads_ascend(study, basis):
    table = static_tip(study, basis)
    assert table["load_N"].tolist() == [0.0, 20.0, 100.0]
    for model in ("exact", "fom", "rom"):
        assert table.iloc[0][[f"x_{model}_m", f"z_{model}_m"]].tolist() == pytest.approx(
            [1.0, 0.0], abs=1e-12
        )


def test_models_lie_near_the_exact_elastica_and_the_full_one_nearer(study, basis):
    table = static_tip(study, basis).iloc[1:]
    error = {
        model: np.hypot(
            table[f"x_{model}_m"] - table["x_exact_m"], table[f"z_{model}_m"] - table["z_exact_m"]
        )
        for model in ("fom", "rom")
    }
    assert (error["fom"] < 0.005).all()
    assert (error["rom"] < 0.02).all()
    assert (error["fom"] < error["rom"]).all()


def test_loads_beyond_the_paper_keep_all_three_on_one_side(study, basis):
    """F L²/EI up to 100, and beyond it where no exact curve is drawn any more."""
    loads = Statics(tip_loads_N=(150.0, 500.0, 525.0, 600.0, 5000.0, 6000.0))
    table = static_tip(study.model_copy(update={"statics": loads}), basis)
    for model in ("exact", "fom", "rom"):
        assert (table[f"z_{model}_m"].dropna() > 0.5).all()
    assert table["z_exact_m"].isna().tolist() == [False] * 5 + [True]
    assert np.abs(table["z_fom_m"] - table["z_exact_m"])[:4].max() < 0.4 / 4**2  # second order, four elements


def test_a_beam_that_twists_has_no_exact_curve(study, structure):
    twisting = structure.model_copy(
        update={"joints": ("out_of_plane", "torsion"), "torsional_stiffness_N_m2": 50.0,
                "torsional_inertia_per_length_kg_m": 0.1}
    )  # fmt: skip
    table = static_tip(study, reduce(twisting, study.reduction))
    assert table[["x_exact_m", "z_exact_m"]].isna().all(axis=None)
    assert table[["x_fom_m", "z_rom_m"]].notna().all(axis=None)


def test_a_truncation_keeps_the_first_frequencies(structure, study):
    basis = reduce(structure, study.reduction.model_copy(update={"modes": 2}))
    table = natural_frequencies(basis)
    assert table["rom_rad_s"].tolist()[:2] == pytest.approx(table["fom_rad_s"].tolist()[:2], rel=1e-12)
    assert table["rom_rad_s"].isna().tolist() == [False, False, True, True]


def test_exact_frequencies_are_those_of_the_clamped_free_beam(basis):
    table = natural_frequencies(basis)
    # Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1
    roots = np.array([1.87510407, 4.69409113, 7.85475744, 10.99554073])
    assert table["exact_rad_s"].to_numpy() == pytest.approx(roots**2 * np.sqrt(50.0 / 0.2), rel=1e-8)
    assert table["fom_rad_s"][0] == pytest.approx(table["exact_rad_s"][0], rel=0.01)


def test_published_frequencies_stand_beside_the_structure_they_belong_to(structure, study):
    wing = structure.model_copy(update={"name": "wing", "elements": 10})
    table = natural_frequencies(reduce(wing, study.reduction))
    fom, rom = FREQUENCIES_RAD_S["wing"]
    assert table["published_fom_rad_s"].dropna().tolist() == list(fom)
    assert table["published_rom_rad_s"].dropna().tolist() == list(rom)
    assert natural_frequencies(reduce(structure, study.reduction))["published_fom_rad_s"].isna().all()
