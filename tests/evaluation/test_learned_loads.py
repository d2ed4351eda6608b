"""Generalised forces from learned positions and directions, against those of the exact kinematics."""

import numpy as np
import pytest

from flexsurr.beam import loaded, reduce, reduced_order
from flexsurr.beam.loads import Forces, Part, acting, load_parts
from flexsurr.config.history import Constant, Power, Sine
from flexsurr.config.load import DistributedForce, SeveralLoads, Spread, TipForce, TipMoment
from flexsurr.config.structure import Structure
from flexsurr.config.study import (
    EvaluationSettings,
    LearnedLoadSettings,
    Reduction,
)
from flexsurr.evaluation.candidates import with_learned_loads
from flexsurr.evaluation.cases import evaluation_cases
from flexsurr.evaluation.cost import cost_table
from flexsurr.evaluation.learned_loads import (
    exact_forces,
    learn_forces,
    learn_kinematics,
    learned_load_table,
    relative_error,
)
from flexsurr.report.tables import learned_loads
from flexsurr.simulation import simulate
from flexsurr.simulation.history import factor

TWISTED = Structure(
    name="twisted",
    length_m=2.0,
    elements=4,
    joints=("in_plane", "out_of_plane", "torsion"),
    clamp_theta_deg=4.0,
    clamp_phi_deg=10.0,
    mass_per_length_kg_m=1.0,
    centre_of_gravity_offset_m=0.03,
    torsional_inertia_per_length_kg_m=0.02,
    bending_stiffness_in_plane_N_m2=400.0,
    bending_stiffness_out_of_plane_N_m2=50.0,
    torsional_stiffness_N_m2=30.0,
)
GENERATOR = np.random.default_rng(3)


@pytest.fixture(scope="module")
def twisted():
    return reduce(TWISTED, Reduction(modes=3, normalisation="unit"))


def coordinates(count):
    return GENERATOR.uniform(-0.4, 0.4, (count, 3))


def settings(**learned):
    load = DistributedForce(
        along_y=Spread(force_N_m=1.0, shape="one_minus_elliptic"),
        along_z=Spread(force_N_m=3.0, shape="elliptic"),
        history=Power(exponent=2),
    )
    return EvaluationSettings(load=load, learned_load=LearnedLoadSettings(**learned))


def test_the_exact_forces_are_those_of_the_loaded_model(twisted):
    load = settings().load
    model = loaded(reduced_order(twisted, "hamiltonian", "numpy"), twisted, load, "numpy")
    eta = coordinates(4)
    parts = load_parts(TWISTED, load)
    now = acting(TWISTED.elements, parts, [1.0])
    expected = [model.generalised_force(at, np.zeros_like(at), now) for at in eta]
    np.testing.assert_allclose(exact_forces(twisted, parts, eta), expected, rtol=1e-12)


@pytest.mark.parametrize("what", ["on_centres", "on_tip"])
def test_virtual_work_of_what_was_learned_is_that_of_the_kinematics(twisted, what):
    """On the centres and on the tip, and the better the degree the closer."""
    load = Forces.none(TWISTED.elements)
    load = load._replace(**{what: GENERATOR.normal(size=getattr(load, what).shape)})
    eta, held_out = coordinates(1500), coordinates(100)
    exact = exact_forces(twisted, [Part(load, False, Constant())], held_out)
    errors = [
        relative_error(learn_kinematics(twisted, eta, degree).generalised_force(held_out, load), exact)
        for degree in (3, 5, 7)
    ]
    assert errors[2] < 0.1 * errors[1] < 0.01 * errors[0] * 2.0
    assert errors[2] < 1e-4


def test_errors_are_of_what_is_learned(twisted):
    eta, held_out = coordinates(1500), coordinates(200)
    chosen = settings(kinematics_degree=7, degree=5, hidden=8, epochs=100)
    learned = learn_forces(twisted, chosen, eta, held_out)
    table = learned_load_table("study", twisted, "hamiltonian", learned, held_out).set_index("map")
    assert list(table.index) == ["kinematics", "polynomial", "network"]
    assert (table["force_relative_error"] < [1e-4, 1e-3, 2e-2]).all()
    assert 0.0 < table.loc["kinematics", "tip_rms_over_length"] < 1e-5
    assert 0.0 < table.loc["kinematics", "twist_largest_error_rad"] < 1e-3
    expected = exact_forces(twisted, learned.load, held_out)
    assert table.loc["network", "force_relative_error"] == relative_error(learned.network(held_out), expected)


def test_several_loads_that_follow_are_learned_each_with_its_history(twisted):
    """What positions do not tell is learned from the exact forces; the loaded model is the same."""
    load = SeveralLoads(
        loads=(
            TipForce(force_N=2.0, follows=True, history=Sine(frequency_rad_s=5.0)),
            TipMoment(moment_N_m=1.0, history=Power(exponent=1)),
        )
    )
    eta, held_out = coordinates(600), coordinates(50)
    chosen = EvaluationSettings(load=load, learned_load=LearnedLoadSettings(degree=6, hidden=4, epochs=2))
    learned = learn_forces(twisted, chosen, eta, held_out)
    assert learned.polynomial.output_names == tuple(f"Q{k}_of_load_{j}" for j in (1, 2) for k in (1, 2, 3))
    table = learned_load_table("study", twisted, "hamiltonian", learned, held_out).set_index("map")
    assert list(table.index) == ["polynomial", "network"]
    assert learned_loads(table.reset_index())["tip_rms_over_length"].isna().all()
    assert table.loc["polynomial", "force_relative_error"] < 1e-3
    free = reduced_order(twisted, "hamiltonian", "numpy")
    under = loaded(free, twisted, load, "numpy")
    factors = np.array([factor(part.history, 0.7) for part in load.parts])
    for at in held_out[:3]:
        x = np.concatenate([at, np.zeros(3)])
        expected = under.derivative(0.7, x)[3:] - free.derivative(0.7, x)[3:]
        found = factors @ learned.polynomial(at[None]).reshape(2, 3)
        np.testing.assert_allclose(found, expected, atol=1e-2 * np.abs(expected).max())


def test_only_a_symmetric_structure_has_forces_of_even_powers(twisted, study, structure):
    eta, held_out = coordinates(600), coordinates(100)
    pitched = learn_forces(twisted, settings(degree=4, hidden=2, epochs=2), eta, held_out)
    assert np.any(pitched.polynomial.exponents.sum(axis=1) % 2)
    straight = learn_forces(reduce(structure, study.reduction), study.evaluation, eta[:, :1], held_out[:, :1])
    assert not np.any(straight.polynomial.exponents % 2)


def test_a_surrogate_under_it_follows_the_one_under_the_exact_load(study, basis, fitted):
    eta = np.linspace(-0.8, 0.8, 400)[:, None]
    learned = learn_forces(basis, study.evaluation, eta, eta[::7])
    maps = {"learned_load": learned.polynomial, "network_load": learned.network}
    candidates = with_learned_loads("polynomial", fitted, maps)
    assert [candidate.model for candidate in candidates] == [
        "polynomial_learned_load",
        "polynomial_network_load",
    ]
    case = evaluation_cases(basis, study, "forced")[0]
    t = np.linspace(0.0, 0.3, 31)
    tight = study.evaluation.reference_integrator
    exact = loaded(candidates[0].field, basis, case.load, "compiled")
    expected = simulate(exact, t, case.x0, tight).x
    assert np.abs(expected[:, 0]).max() > 0.01
    for candidate in candidates:
        found = simulate(candidate.under(basis, case), t, case.x0, tight).x
        np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())
    free = evaluation_cases(basis, study, "free")[0]
    assert candidates[0].under(basis, free) is candidates[0].field


def test_the_cost_table_has_their_rows(study, basis, fitted):
    eta = np.linspace(-0.8, 0.8, 200)[:, None]
    learned = learn_forces(basis, study.evaluation, eta, eta[::7])
    more = with_learned_loads("polynomial", fitted, {"learned_load": learned.polynomial})
    table = cost_table("short", study, basis, "hamiltonian", "forced", {}, more)
    rows = table[table["model"] == "polynomial_learned_load"]
    assert set(rows["implementation"]) == {"compiled"}
    assert len(rows) == 1 + len(study.evaluation.integrators)
    assert (rows["diverged"] == 0).all()
    assert rows["tip_error_percent"].min() < 0.01


def test_what_does_not_vary_is_refused(twisted):
    with pytest.raises(ValueError, match="coordinate 3 is zero"):
        learn_forces(twisted, settings(), coordinates(50) * [1.0, 1.0, 0.0], coordinates(5))
