"""The simulations by which models are judged: each by itself reproducible, and none used for training."""

import numpy as np
import pytest

from flexsurr.beam import draw_initial_conditions, reduce, reduced_order
from flexsurr.config.load import TipForce
from flexsurr.config.structure import Structure
from flexsurr.evaluation.accuracy import tip_error
from flexsurr.evaluation.cases import (
    FIRST_EVALUATION_CASE,
    FIRST_SELECTION_CASE,
    evaluation_cases,
    forced_cases,
    free_cases,
    reference_solution,
    rest_state,
    sample_times,
)


@pytest.mark.parametrize("draw", [free_cases, forced_cases])
def test_a_case_depends_on_its_number_alone(draw, study, basis):
    many, one = draw(basis, study, 5, 4), draw(basis, study, 7, 1)
    assert one[0].number == many[2].number == 7
    assert np.array_equal(one[0].x0, many[2].x0)
    assert one[0].load == many[2].load


def test_no_state_is_used_for_two_purposes(study, basis):
    training = draw_initial_conditions(basis, study.dataset.initial_conditions, study.seed, 0, 200)
    selection = free_cases(basis, study, FIRST_SELECTION_CASE, 200)
    evaluation = free_cases(basis, study, FIRST_EVALUATION_CASE, 200)
    states = [*training, *(case.x0 for case in selection), *(case.x0 for case in evaluation)]
    assert len(np.unique(states, axis=0)) == 600


def test_forces_end_at_random_within_the_longest_time(study, basis):
    ends = [case.free_from_s for case in forced_cases(basis, study, 0, 200)]
    longest_s = study.evaluation.longest_load_s
    assert 0.0 < min(ends) < 0.1 * longest_s
    assert 0.9 * longest_s < max(ends) <= longest_s


def test_forced_responses_start_at_rest_and_free_ones_know_no_load(study, basis):
    model = reduced_order(basis, "hamiltonian", "numpy")
    for case in evaluation_cases(basis, study, "forced"):
        assert model.derivative(0.0, case.x0) == pytest.approx(0.0, abs=1e-9)
    assert all(
        case.load is None and case.free_from_s == 0.0 for case in evaluation_cases(basis, study, "free")
    )


def test_at_rest_under_a_load_spring_and_load_balance(basis):
    state = rest_state(basis, TipForce(force_N=50.0))
    model = reduced_order(basis, "hamiltonian", "numpy")
    step = 1e-6 * np.array([1.0, 0.0])
    work = 50.0 * (model.tip(state + step)[2] - model.tip(state - step)[2]) / 2e-6
    assert model.derivative(0.0, state)[1] == pytest.approx(-work, rel=1e-6)


def test_the_reference_conserves_energy_far_below_what_tables_show(study, basis):
    t = sample_times(1.0, 0.01)
    case = evaluation_cases(basis, study, "free")[0]
    tight = study.evaluation.reference_integrator
    solution = reference_solution(basis, "hamiltonian", case, t, tight)
    energy = reduced_order(basis, "hamiltonian", "numpy").energy(solution.x)
    assert np.ptp(energy) < 1e-9 * energy[0]
    assert np.linalg.norm(solution.motion - [1.0, 0.0, 0.0], axis=1).max() == pytest.approx(solution.peak)


def test_sample_times_hold_both_ends():
    assert sample_times(0.3, 0.1) == pytest.approx([0.0, 0.1, 0.2, 0.3])
    assert sample_times(0.05, 0.1) == pytest.approx([0.0, 0.05])


ROD = Structure(
    name="rod",
    length_m=1.0,
    elements=4,
    joints=("torsion",),
    mass_per_length_kg_m=0.2,
    torsional_stiffness_N_m2=5.0,
    torsional_inertia_per_length_kg_m=0.01,
)
SOFT_IN_TORSION = {"bending_stiffness_out_of_plane_N_m2": 1e4, "joints": ("out_of_plane", "torsion")}


@pytest.mark.parametrize("more", [{}, SOFT_IN_TORSION])
def test_what_only_twists_is_judged_by_its_twist(study, more):
    """A rod, or the torsional mode of a beam that could bend: its tip stays where it is."""
    structure = Structure.model_validate(ROD.model_dump() | more)
    basis = reduce(structure, study.reduction)
    case = evaluation_cases(basis, study, "free")[0]
    tight = study.evaluation.reference_integrator
    solution = reference_solution(basis, "hamiltonian", case, sample_times(0.1, 0.01), tight)
    model = reduced_order(basis, "hamiltonian", "numpy")
    assert solution.motion.shape == (11, 1)
    assert solution.motion[:, 0] == pytest.approx(model.twist(solution.x))
    assert tip_error(solution, solution.motion).whole_percent == 0.0
    assert tip_error(solution, solution.motion + 0.1 * solution.peak).whole_percent == pytest.approx(10.0)


def test_a_reference_that_stays_at_rest_judges_nothing(study):
    """A load across the plane of the softest mode, of a beam whose joints feel it."""
    values = ROD.model_dump() | SOFT_IN_TORSION
    basis = reduce(Structure.model_validate(values), study.reduction)
    case = evaluation_cases(basis, study, "forced")[0]
    tight = study.evaluation.reference_integrator
    with pytest.raises(ArithmeticError, match="the load moves none of the modes"):
        reference_solution(basis, "hamiltonian", case, sample_times(0.1, 0.01), tight)
