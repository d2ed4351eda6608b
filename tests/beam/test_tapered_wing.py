"""The example that ships: a tapered, swept wing with an engine, from its files to its frequencies."""

from pathlib import Path

import numpy as np
import pytest
from structures import change

from flexsurr.beam import find_equilibrium, natural_modes, tip_position
from flexsurr.beam.chain import chain
from flexsurr.beam.soundness import check_structure, unit_hint
from flexsurr.config.structure_file import read_structure

WING = read_structure(Path(__file__).parents[2] / "config/structures/tapered_wing.yaml")


def test_its_files_make_a_sound_structure():
    check_structure(WING)
    assert unit_hint(WING) == ""
    table = WING.along_span
    assert chain(WING).masses.sum() == pytest.approx(
        14.0 + np.trapezoid(table.mass_per_length_kg_m, table.s_m)
    )
    sag = tip_position(WING, find_equilibrium(WING)) - tip_position(WING, np.zeros(WING.coordinates))
    assert -0.01 * WING.length_m < sag[2] < 0.0


def test_its_frequencies_have_converged():
    coarse, fine = (
        natural_modes(wing, find_equilibrium(wing))[0][:3] for wing in (WING, change(WING, elements=32))
    )
    np.testing.assert_allclose(coarse, fine, rtol=5e-3)
