"""From a sweep to trials and their names."""

import itertools
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
    assert {run_id(t, "s", "v", "d") for t in before} < {run_id(t, "s", "v", "d") for t in after}


@pytest.mark.parametrize(
    ("space", "reason"),
    [
        (Space(architecture="polynomial", degree=(4,)), "least_squares"),
        (Space(architecture="hnn", hidden=((8,),)), "hnn with levenberg_marquardt takes activation"),
        (
            Space(architecture="mlp", hidden=((8,),), activation=("elu",), optimiser=("adam",)),
            "mlp with adam takes learning_rate and batch_size",
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
    ids = {run_id(t, *of) for t in trials for of in itertools.product("ab", "xy", ("data", "others"))}
    assert len(ids) == 8 * len(trials)
    assert all(re.fullmatch(r"(hnn|polynomial)-[0-9a-f]{10}", name) for name in ids)


def test_run_ids_do_not_change_unnoticed():
    """A change of these names reruns every run there is: intended, or a mistake."""
    trial = Trial(architecture="polynomial", degree=6, optimiser="least_squares")
    assert run_id(trial, "cantilever", "hamiltonian", "0123456789abcdef") == "polynomial-8466707c38"


def test_a_default_that_is_spelled_out_is_the_same_run():
    short = Trial(architecture="hnn", hidden=(8,), activation="elu")
    assert short == Trial(architecture="hnn", hidden=(8,), activation="elu", scaling="canonical", epochs=1000)
    assert Trial.model_validate(short.model_dump(mode="json")) == short


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"learning_rate": 0.01}, "learning_rate does nothing with levenberg_marquardt; allowed: "),
        ({"loss": "norms"}, "loss does nothing with levenberg_marquardt"),
        ({"degree": 4}, "degree does nothing with hnn"),
        ({"optimiser": "lbfgs", "batch_size": 8}, "batch_size does nothing with lbfgs"),
        ({"optimiser": "least_squares"}, "does nothing with least_squares|does not fit this hnn"),
        ({"scaling": "per_trajectory"}, "canonical"),
    ],
)
def test_what_would_do_nothing_is_refused(changes, reason):
    with pytest.raises(ValueError, match=reason):
        Trial(**{"architecture": "hnn", "hidden": (8,), "activation": "elu", **changes})


@pytest.mark.parametrize(
    "values",
    [
        {"architecture": "port_hamiltonian", "degree": 4, "optimiser": "least_squares"},
        {"architecture": "mlp", "hidden": (8,), "activation": "elu", "optimiser": "lbfgs"},
    ],
)
def test_every_kind_of_trial_may_sample_configurations(values):
    trained, sampled = Trial(**values), Trial(**values, configurations=100)
    assert trained.configurations is None
    assert run_id(trained, "s", "v", "d") != run_id(sampled, "s", "v", "d")
    with pytest.raises(ValueError, match="greater than or equal to 1"):
        Trial(**values, configurations=0)


def test_a_seed_does_nothing_to_least_squares():
    with pytest.raises(ValueError, match="seed does nothing with least_squares; allowed: conf"):
        Trial(architecture="polynomial", degree=6, optimiser="least_squares", seed=1)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({}, "takes degree"),
        ({"degree": 4}, "least_squares"),
        (
            {"degree": 4, "optimiser": "least_squares", "scaling": "per_feature"},
            "scaling does nothing with port_hamiltonian",
        ),
        ({"hidden": (8,), "activation": "silu", "optimiser": "lbfgs"}, "levenberg_marquardt"),
        ({"hidden": (8, 8), "activation": "silu"}, "one hidden layer, not 2"),
        ({"hidden": (8,), "activation": "silu", "degree": 4}, "degree does nothing"),
    ],
)
def test_a_port_hamiltonian_trial_is_one_of_two(changes, reason):
    with pytest.raises(ValueError, match=reason):
        Trial(architecture="port_hamiltonian", **changes)
