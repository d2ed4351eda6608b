"""Shapes of the structure: modes of the size that is drawn, and equilibria as the models have them."""

import numpy as np
import pytest

from flexsurr.beam import reduce
from flexsurr.config.structure import Structure
from flexsurr.config.study import Reduction, Statics
from flexsurr.evaluation.statics import REACH, SHAPE_COLUMNS, shapes_table, static_tip

POINT = ["x_m", "y_m", "z_m"]


@pytest.fixture(scope="module")
def table(study, basis):
    return shapes_table(study, basis)


def test_its_columns_are_as_named(table):
    assert tuple(table.columns) == SHAPE_COLUMNS


def test_static_shapes_end_where_the_table_of_tips_says(table, study, basis):
    tips = static_tip(study, basis)
    last = table[(table["kind"] == "static") & (table["node"] == basis.structure.elements)]
    for model in ("fom", "rom"):
        ends = last[last["model"] == model].sort_values("load_N")
        np.testing.assert_allclose(ends["load_N"], tips["load_N"])
        for axis in "xz":
            np.testing.assert_allclose(ends[f"{axis}_m"], tips[f"{axis}_{model}_m"], atol=1e-12)


@pytest.mark.parametrize("joint", ["out_of_plane", "in_plane", "torsion", "axial"])
def test_every_kind_of_mode_is_seen(study, joint):
    """The strip moves by a fifth of the length, to first order; also where its axis stays."""
    rod = Structure(
        name="rod",
        length_m=3.0,
        elements=6,
        joints=(joint,),
        mass_per_length_kg_m=1.0,
        bending_stiffness_in_plane_N_m2=10.0,
        bending_stiffness_out_of_plane_N_m2=10.0,
        torsional_stiffness_N_m2=10.0,
        torsional_inertia_per_length_kg_m=0.01,
        axial_stiffness_N=100.0,
    )
    basis = reduce(rod, Reduction(modes=2))
    shapes = shapes_table(study.model_copy(update={"statics": Statics(tip_loads_N=(0.0,))}), basis)
    rest = shapes[shapes["kind"] == "rest"][POINT].to_numpy()
    for number in (1, 2):
        mode = shapes[(shapes["kind"] == "mode") & (shapes["number"] == number)]
        assert mode["omega_rad_s"].iloc[0] == basis.omega_rad_s[number - 1]
        moved = np.linalg.norm(mode[POINT].to_numpy() - rest, axis=1).max()
        assert 0.3 * REACH * rod.length_m < moved < 1.25 * REACH * rod.length_m
