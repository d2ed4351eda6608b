"""The wing of config/structures against the study's Table 3, and the misprint of its Table 2."""

from pathlib import Path

import numpy as np
import pytest

from flexsurr.beam import reduce
from flexsurr.config.reading import read_yaml
from flexsurr.config.structure import Structure
from flexsurr.config.study import Reduction
from flexsurr.evaluation.statics import natural_frequencies

STRUCTURES = Path(__file__).resolve().parents[2] / "config" / "structures"


def frequencies(name):
    structure = Structure(**read_yaml(STRUCTURES / f"{name}.yaml"))
    return natural_frequencies(reduce(structure, Reduction(modes=3, normalisation="mass")))


def test_the_full_order_model_has_the_published_frequencies():
    table = frequencies("wing").head(9)
    published = table["published_fom_rad_s"].to_numpy()
    error = np.abs(table["fom_rad_s"].to_numpy() - published)
    # 0.06 %, or what two decimals leave open
    assert (error <= np.maximum(6e-4 * published, 0.005)).all()


def test_a_truncation_at_three_modes_cannot_have_the_published_reduced_row():
    """Its first three frequencies are those of the full order; the published ones are higher."""
    table = frequencies("wing")
    assert table["rom_rad_s"][:3].tolist() == pytest.approx(table["fom_rad_s"][:3].tolist(), rel=1e-9)
    assert table["rom_rad_s"].notna().sum() == 3
    published = table["published_rom_rad_s"][1:3].to_numpy()
    assert (published / table["rom_rad_s"][1:3].to_numpy() > 1.003).all()


def test_to_the_letter_the_printed_table_has_another_torsion():
    table = frequencies("wing_as_printed")
    assert table["fom_rad_s"][:3].tolist() == pytest.approx([2.209, 3.631, 10.235], abs=5e-4)
    assert table["published_fom_rad_s"][1] / table["fom_rad_s"][1] > 2.5
