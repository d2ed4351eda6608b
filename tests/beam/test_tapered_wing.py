"""The example that ships: a tapered, swept wing with an engine, from its files to a response."""

from pathlib import Path

import numpy as np
import pytest
from structures import change, state
from test_implementations import assert_close

from flexsurr.beam import find_equilibrium, loaded, natural_modes, reduce, reduced_order, tip_position
from flexsurr.beam.chain import chain
from flexsurr.beam.soundness import check_structure, unit_hint
from flexsurr.config.history import Sine
from flexsurr.config.load import TipForce
from flexsurr.config.study import Integrator, Reduction
from flexsurr.config.study_files import read_structure
from flexsurr.simulation import simulate

WING = read_structure(Path(__file__).parents[2] / "config/structures/tapered_wing.yaml")


def test_its_files_make_a_sound_structure():
    check_structure(WING)
    assert unit_hint(WING) == ""
    table = WING.along_span
    assert chain(WING).masses.sum() == pytest.approx(
        14.0 + np.trapezoid(table.mass_per_length_kg_m, table.stations_m)
    )
    sag = tip_position(WING, find_equilibrium(WING)) - tip_position(WING, np.zeros(WING.coordinates))
    assert -0.01 * WING.length_m < sag[2] < 0.0


def test_its_frequencies_have_converged():
    coarse, fine = (
        natural_modes(wing, find_equilibrium(wing))[0][:3] for wing in (WING, change(WING, elements=32))
    )
    np.testing.assert_allclose(coarse, fine, rtol=5e-3)


def test_reduced_under_a_load_it_responds_alike_in_all_implementations_and_keeps_its_energy():
    basis = reduce(WING, Reduction(modes=3, normalisation="mass", about="equilibrium"))
    load = TipForce(force_N=50.0, history=Sine(frequency_rad_s=15.0))
    x = state(basis, 1)
    described, vectorised, compiled = (
        loaded(reduced_order(basis, "hamiltonian", kind), basis, load, kind).derivative(0.05, x)
        for kind in ("described", "numpy", "compiled")
    )
    assert_close(vectorised, described)
    assert_close(compiled, described)
    still = change(WING, damping_in_plane_s=0.0, damping_out_of_plane_s=0.0, damping_torsion_s=0.0)
    basis = reduce(still, Reduction(modes=3, normalisation="mass"))
    model = reduced_order(basis, "hamiltonian", "compiled")
    start = np.array([0.5, 0.1, -0.1, 2.0, 0.0, 1.0])
    tight = Integrator(method="scipy_dop853", rtol=1e-10, atol=1e-12)
    energy = model.energy(simulate(model, np.linspace(0.0, 1.0, 21), start, tight).x)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8, atol=1e-8 * np.ptp(energy))
