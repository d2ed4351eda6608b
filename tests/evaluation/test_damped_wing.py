"""The damped wing: laws of energy, and what no D-HNN can be."""

import numpy as np
import pytest

from flexsurr.beam import draw_initial_conditions, loaded, reduce, reduced_order
from flexsurr.config.history import Power
from flexsurr.config.load import DistributedForce, Spread
from flexsurr.config.structure import Structure
from flexsurr.config.study import (
    InitialConditions,
    Integrator,
    Reduction,
)
from flexsurr.evaluation.dissipative_structure import dissipative_asymmetry
from flexsurr.evaluation.energy import energy_balance
from flexsurr.simulation import simulate

WING = Structure(
    name="wing",
    length_m=16.0,
    elements=6,
    joints=("out_of_plane", "torsion"),
    mass_per_length_kg_m=0.75,
    bending_stiffness_out_of_plane_N_m2=2e4,
    torsional_stiffness_N_m2=1e3,
    torsional_inertia_per_length_kg_m=0.1,
    chord_m=1.0,
    centre_of_gravity_offset_m=0.267,
    damping_out_of_plane_s=0.1,
    damping_torsion_s=10.0,
)
# SciPy's: nothing to compile
TIGHT = Integrator(method="scipy_radau", rtol=1e-9, atol=1e-11)
LOAD = DistributedForce(
    along_y=Spread(force_N_m=0.5, shape="one_minus_elliptic"),
    along_z=Spread(force_N_m=2.0, shape="elliptic"),
    history=Power(exponent=2, end_s=2.0),
)


def basis_of(structure=WING, normalisation="mass"):
    return reduce(structure, Reduction(modes=3, normalisation=normalisation))


def states(basis, count=5):
    return draw_initial_conditions(basis, InitialConditions(), 2024, 0, count)


@pytest.mark.parametrize("load", [None, LOAD])
def test_work_of_the_load_is_change_of_energy_and_what_the_dampers_take(load):
    basis = basis_of()
    model = reduced_order(basis, "hamiltonian", "compiled")
    field = model if load is None else loaded(model, basis, load, "compiled")
    # the torsion damper's first milliseconds are the steepest; short of the load's end, where power jumps
    t = np.concatenate([np.geomspace(1e-5, 0.1, 600), np.linspace(0.11, 1.999, 1000)])
    x0 = states(basis, 1)[0] if load is None else np.zeros(6)
    x = simulate(field, t, x0, TIGHT).x
    balance = energy_balance(model, basis, load, t, x)
    assert balance.dissipated[-1] > 1.0
    assert (np.diff(balance.dissipated) >= 0.0).all()
    size = np.abs(balance.change).max()
    assert np.abs(balance.residual).max() < 1e-6 * size
    assert (load is None) == (not balance.work.any())


def test_without_the_gyroscopic_term_energy_does_not_balance():
    basis = basis_of()
    model = reduced_order(basis, "as_printed", "compiled")
    t = np.concatenate([np.geomspace(1e-5, 0.1, 600), np.linspace(0.11, 1.999, 1000)])
    balance = energy_balance(model, basis, None, t, simulate(model, t, states(basis, 1)[0], TIGHT).x)
    assert np.abs(balance.residual).max() > 1e-3 * np.abs(balance.change).max()


def test_the_damped_wing_is_no_d_hnn_and_the_undamped_one_is():
    undamped = WING.model_copy(update={"damping_out_of_plane_s": 0.0, "damping_torsion_s": 0.0})
    for normalisation in ("mass", "unit"):
        asymmetry = {}
        for structure in (WING, undamped):
            basis = basis_of(structure, normalisation)
            model = reduced_order(basis, "hamiltonian", "compiled")
            asymmetry[structure.damping_torsion_s] = dissipative_asymmetry(model, states(basis))
        assert asymmetry[10.0].mixed > 0.1
        assert asymmetry[10.0].direct > 0.01
        assert max(asymmetry[0.0].mixed, asymmetry[0.0].direct) < 1e-7


def test_at_small_amplitude_mass_normalised_modes_are_a_d_hnn_and_unit_norm_ones_are_not():
    for normalisation, possible in (("mass", True), ("unit", False)):
        basis = basis_of(normalisation=normalisation)
        model = reduced_order(basis, "hamiltonian", "compiled")
        mixed = dissipative_asymmetry(model, 1e-4 * states(basis)).mixed
        assert mixed < 1e-3 if possible else mixed > 0.1


def test_a_single_mode_is_always_a_d_hnn():
    basis = reduce(WING, Reduction(modes=1))
    with pytest.raises(ValueError, match="single mode"):
        dissipative_asymmetry(reduced_order(basis, "hamiltonian", "numpy"), np.ones((1, 2)))
