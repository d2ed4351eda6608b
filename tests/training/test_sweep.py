"""From a sweep to trials and their names."""

import itertools
import re

import pytest

from flexsurr.config.sweep import FieldSweep, MapSweep
from flexsurr.config.trial import (
    FIELDS,
    MAPS,
    OPTIMISERS,
    FirstOrder,
    MapNetwork,
    dimensions,
    named,
    settings_of,
    trial_of,
)
from flexsurr.training import expand, run_id

NETWORKS = {
    "architecture": "hnn",
    "hidden": ((8,), (16,), (8, 8)),
    "activation": ("softplus", "elu"),
    "seed": (0, 1),
}
POLYNOMIALS = {"architecture": "polynomial", "degree": (4, 6), "optimiser": ("least_squares",)}


def test_a_grid_is_every_combination_once_in_order():
    trials = expand(FieldSweep(spaces=(POLYNOMIALS, NETWORKS, NETWORKS)))
    assert len(trials) == len(set(trials)) == 2 + 12
    assert [trial.degree for trial in trials[:2]] == [4, 6]
    assert trials[2] == trial_of(architecture="hnn", hidden=(8,), activation="softplus", seed=0)
    assert trials[-1] == trial_of(architecture="hnn", hidden=(8, 8), activation="elu", seed=1)


def test_random_draws_are_seeded_different_and_of_the_grid():
    sweep = FieldSweep(search="random", draws=5, seed=3, spaces=(NETWORKS, POLYNOMIALS))
    trials = expand(sweep)
    assert trials == expand(sweep)
    assert len(set(trials)) == 5 + 2  # a space with fewer combinations gives them all
    assert set(trials) <= set(expand(FieldSweep(spaces=sweep.spaces)))
    others = [expand(sweep.model_copy(update={"seed": seed})) for seed in range(4, 8)]
    assert any(set(other) != set(trials) for other in others)


def test_a_value_more_keeps_the_other_runs():
    before = expand(FieldSweep(spaces=(NETWORKS,)))
    wider = NETWORKS | {"activation": ("softplus", "elu", "silu")}
    after = expand(FieldSweep(spaces=(wider,)))
    assert {run_id(t, "s", "v", "d") for t in before} < {run_id(t, "s", "v", "d") for t in after}


@pytest.mark.parametrize(
    ("space", "reason"),
    [
        ({"architecture": "polynomial", "degree": [4]}, "least_squares"),
        ({"architecture": "hnn", "hidden": ((8,),)}, "hnn with levenberg_marquardt takes activation"),
        (
            {"architecture": "mlp", "hidden": ((8,),), "activation": ("elu",), "optimiser": ("adam",)},
            "mlp with adam takes learning_rate and batch_size",
        ),
    ],
)
def test_a_combination_that_makes_no_trial_is_named(space, reason):
    with pytest.raises(ValueError, match=reason) as caught:
        expand(FieldSweep(spaces=(NETWORKS, space)))
    assert "spaces, number 2 (" in str(caught.value)
    assert f"architecture: {space['architecture']}" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_run_ids_name_their_content():
    trials = expand(FieldSweep(spaces=(NETWORKS, POLYNOMIALS)))
    ids = {run_id(t, *of) for t in trials for of in itertools.product("ab", "xy", ("data", "others"))}
    assert len(ids) == 8 * len(trials)
    assert all(re.fullmatch(r"(hnn|polynomial)-[0-9a-f]{10}", name) for name in ids)


def test_run_ids_do_not_change_unnoticed():
    """A change of these names reruns every run there is: intended, or a mistake."""
    trial = trial_of(architecture="polynomial", degree=6, optimiser="least_squares")
    assert run_id(trial, "cantilever", "hamiltonian", "0123456789abcdef") == "polynomial-1b1fecd594"


def test_a_default_that_is_spelled_out_is_the_same_run():
    short = trial_of(architecture="hnn", hidden=(8,), activation="elu")
    spelled = {"scaling": "canonical", "optimiser": "levenberg_marquardt", "epochs": 1000, "seed": 0}
    assert short == trial_of(architecture="hnn", hidden=(8,), activation="elu", **spelled)
    assert trial_of(**short.model_dump(mode="json")) == short


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
        trial_of(**{"architecture": "hnn", "hidden": (8,), "activation": "elu", **changes})


@pytest.mark.parametrize(
    "values",
    [
        {"architecture": "port_hamiltonian", "degree": 4, "optimiser": "least_squares"},
        {"architecture": "mlp", "hidden": (8,), "activation": "elu", "optimiser": "lbfgs"},
    ],
)
def test_every_kind_of_trial_may_sample_configurations(values):
    trained, sampled = trial_of(**values), trial_of(**values, configurations=100)
    assert trained.configurations is None
    assert run_id(trained, "s", "v", "d") != run_id(sampled, "s", "v", "d")
    with pytest.raises(ValueError, match="greater than or equal to 1"):
        trial_of(**values, configurations=0)


OWN = "my_models.py:MyField"


def test_options_of_ones_own_network_are_dimensions_of_the_search():
    options = {"hidden": ([8], [8, 8]), "activation": ("tanh", "silu")}
    space = {"architecture": OWN, "options": options, "seed": [0, 1]}
    trials = expand(FieldSweep(spaces=[space, space]), {OWN: "a" * 64})
    assert len(trials) == 8
    assert trials[0].options == {"hidden": [8], "activation": "tanh"}
    assert {trial.sha256 for trial in trials} == {"a" * 64}
    ids = {run_id(trial, "s", "v", "d") for trial in trials}
    assert len(ids) == 8
    assert all(re.fullmatch(r"MyField-[0-9a-f]{10}", name) for name in ids)
    edited = expand(FieldSweep(spaces=[space]), {OWN: "b" * 64})
    assert ids.isdisjoint(run_id(trial, "s", "v", "d") for trial in edited)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"hidden": (8,)}, "hidden does nothing with my_models.py:MyField; allowed: "),
        (
            {"optimiser": "levenberg_marquardt"},
            "does not fit this my_models.py:MyField; allowed: lbfgs, adam",
        ),
        ({"optimiser": "adamw"}, "takes learning_rate and batch_size"),
        ({"device": "tpu"}, "cuda"),
        ({"weight_decay": 0.1}, "weight_decay does nothing with lbfgs"),
        (
            {"architecture": "hnn", "hidden": (8,), "activation": "elu", "device": "cpu"},
            "device does nothing",
        ),
    ],
)
def test_what_ones_own_network_takes(changes, reason):
    with pytest.raises(ValueError, match=reason):
        trial_of(**{"architecture": OWN, **changes})


def test_a_seed_does_nothing_to_least_squares():
    with pytest.raises(ValueError, match="seed does nothing with least_squares; allowed: conf"):
        trial_of(architecture="polynomial", degree=6, optimiser="least_squares", seed=1)


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
        trial_of(architecture="port_hamiltonian", **changes)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({}, "network with levenberg_marquardt takes hidden and activation"),
        ({"hidden": (5, 5), "activation": "tanh"}, "one hidden layer, not 2"),
        ({"hidden": (5,), "activation": "tanh", "optimiser": "adam"}, "takes learning_rate and batch_size"),
        ({"architecture": "linear", "optimiser": "least_squares", "hidden": (5,)}, "hidden does nothing"),
        ({"architecture": "linear", "networks": "four"}, "networks does nothing with linear"),
        (
            {"architecture": "linear"},
            "'levenberg_marquardt' does not fit this linear; allowed: least_squares",
        ),
    ],
)
def test_a_map_takes_what_is_its_own(changes, reason):
    with pytest.raises(ValueError, match=reason):
        trial_of(**{"architecture": "network", **changes})


def test_a_trial_is_of_one_architecture_and_one_optimiser():
    adam = {"optimiser": "adam", "learning_rate": 0.1, "batch_size": 8}
    trial = trial_of(architecture="hnn", hidden=(8,), activation="elu", **adam)
    assert isinstance(trial, FirstOrder)
    assert not isinstance(trial, MapNetwork)
    assert not hasattr(trial, "degree")


@pytest.mark.parametrize(("kind", "sweep"), [(FIELDS, FieldSweep), (MAPS, MapSweep)])
def test_a_space_may_vary_whatever_a_trial_takes(kind, sweep):
    taken = {key for record in (*kind, *OPTIMISERS) for key in record.model_fields}
    taken -= {"sha256"}  # that of a file, which nobody writes
    (space,) = sweep(spaces=({"architecture": named(kind, "architecture")[0]},)).spaces
    assert type(space).model_fields.keys() == dimensions(kind).keys() - {"sha256"} == taken


def test_every_setting_of_a_trial_is_recorded():
    trial = trial_of(architecture="network", hidden=(5,), activation="tanh", sampling="sobol")
    settings = settings_of(trial)
    assert {key: settings[key] for key in trial.model_dump()} == trial.model_dump(mode="json")
    assert settings.keys() == dimensions(MAPS).keys()
    assert settings["learning_rate"] is None


def test_no_map_is_called_as_a_field():
    assert not {*named(FIELDS, "architecture")} & {*named(MAPS, "architecture")}
