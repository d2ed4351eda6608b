"""From a sweep to trials and their names."""

import re

import pytest

from flexsurr.config.sweep import Space, Sweep, Trial
from flexsurr.training import expand, run_id

NETWORKS = Space(
    architecture="hnn", hidden=((8,), (16,), (8, 8)), activation=("softplus", "elu"), seed=(0, 1)
)
POLYNOMIALS = Space(architecture="polynomial", degree=(4, 6), optimiser=("least_squares",))


def test_a_grid_is_every_combination_once_in_order():
    trials = expand(Sweep(spaces=(POLYNOMIALS, NETWORKS, NETWORKS)))
    assert len(trials) == len(set(trials)) == 2 + 12
    assert [trial.degree for trial in trials[:2]] == [4, 6]
    assert trials[2] == Trial(architecture="hnn", hidden=(8,), activation="softplus", seed=0)
    assert trials[-1] == Trial(architecture="hnn", hidden=(8, 8), activation="elu", seed=1)


def test_random_draws_are_seeded_different_and_of_the_grid():
    sweep = Sweep(search="random", draws=5, seed=3, spaces=(NETWORKS, POLYNOMIALS))
    trials = expand(sweep)
    assert trials == expand(sweep)
    assert len(set(trials)) == 5 + 2  # a space with fewer combinations gives them all
    assert set(trials) <= set(expand(Sweep(spaces=sweep.spaces)))
    others = [expand(sweep.model_copy(update={"seed": seed})) for seed in range(4, 8)]
    assert any(set(other) != set(trials) for other in others)


def test_a_value_more_keeps_the_other_runs():
    before = expand(Sweep(spaces=(NETWORKS,)))
    wider = NETWORKS.model_copy(update={"activation": ("softplus", "elu", "silu")})
    after = expand(Sweep(spaces=(wider,)))
    assert {run_id(t, "s", "v") for t in before} < {run_id(t, "s", "v") for t in after}


@pytest.mark.parametrize(
    ("space", "reason"),
    [
        (Space(architecture="polynomial", degree=(4,)), "least_squares"),
        (Space(architecture="hnn", hidden=((8,),)), "takes hidden and activation"),
        (
            Space(architecture="mlp", hidden=((8,),), activation=("elu",), optimiser=("adam",)),
            "learning_rate and batch_size",
        ),
    ],
)
def test_a_combination_that_makes_no_trial_is_named(space, reason):
    with pytest.raises(ValueError, match=reason) as caught:
        expand(Sweep(spaces=(NETWORKS, space)))
    assert "spaces, number 2 (" in str(caught.value)
    assert f"architecture: {space.architecture}" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_run_ids_name_their_content():
    trials = expand(Sweep(spaces=(NETWORKS, POLYNOMIALS)))
    ids = {run_id(t, study, variant) for t in trials for study in ("a", "b") for variant in ("x", "y")}
    assert len(ids) == 4 * len(trials)
    assert all(re.fullmatch(r"(hnn|polynomial)-[0-9a-f]{10}", name) for name in ids)


def test_run_ids_do_not_change_unnoticed():
    """A change of these names reruns every run there is: intended, or a mistake."""
    trial = Trial(architecture="polynomial", degree=6, optimiser="least_squares")
    assert run_id(trial, "cantilever", "hamiltonian") == "polynomial-0a5e215ee1"


def test_a_scaling_is_part_of_the_name_unless_it_is_the_usual_one():
    space = NETWORKS.model_copy(update={"scaling": ("canonical", "per_feature"), "seed": (0,)})
    trials = expand(Sweep(spaces=(space,)))
    ids = [run_id(trial, "s", "v") for trial in trials]
    assert len(set(ids)) == len(trials) == 12
    usual = expand(Sweep(spaces=(NETWORKS.model_copy(update={"seed": (0,)}),)))
    assert {run_id(trial, "s", "v") for trial in usual} < set(ids)
    assert all(Trial.model_validate(trial.model_dump(mode="json")) == trial for trial in trials)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({}, "degree, or hidden and activation"),
        ({"degree": 4}, "takes the optimiser least_squares"),
        ({"degree": 4, "optimiser": "least_squares", "scaling": "per_feature"}, "no scaling but canonical"),
        ({"hidden": (8,), "activation": "silu", "optimiser": "lbfgs"}, "levenberg_marquardt"),
        ({"hidden": (8, 8), "activation": "silu"}, "one hidden layer, not 2"),
        ({"hidden": (8,), "activation": "silu", "degree": 4}, "no degree"),
    ],
)
def test_a_port_hamiltonian_trial_is_one_of_two(changes, reason):
    with pytest.raises(ValueError, match=reason):
        Trial(architecture="port_hamiltonian", **changes)
