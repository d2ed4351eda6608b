"""From a sweep to trials and their names."""

import itertools
import re

import numpy as np
import pytest

from flexsurr.config.sweep import FieldSweep, MapSweep, WholeRange
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


RANGES = {
    "architecture": "hnn",
    "hidden": {"low": 4, "high": 64, "scale": "log"},
    "activation": ("softplus", "elu"),
    "optimiser": ("adam",),
    "learning_rate": {"low": 1e-4, "high": 1e-1, "scale": "log"},
    "batch_size": {"low": 16, "high": 18},
}


@pytest.mark.parametrize("search", ["random", "sobol"])
def test_draws_lie_in_their_ranges_differ_and_are_of_their_seed(search):
    sweep = FieldSweep(search=search, draws=64, seed=3, spaces=(RANGES,))
    trials = expand(sweep)
    assert trials == expand(sweep)
    assert len(set(trials)) == 64
    assert {trial.batch_size for trial in trials} == {16, 17, 18}
    assert {trial.activation for trial in trials} == {"softplus", "elu"}
    widths = [trial.hidden[0] for trial in trials]
    assert 4 <= min(widths) < max(widths) <= 64
    rates = np.array([trial.learning_rate for trial in trials])
    assert 1e-4 <= rates.min() < rates.max() <= 1e-1
    # by equal ratios: as many in each decade
    assert all(10 < ((rates >= low) & (rates < 10.0 * low)).sum() < 32 for low in (1e-4, 1e-3, 1e-2))
    assert rates.tolist() == [float(f"{rate:.6g}") for rate in rates]
    assert set(expand(sweep.model_copy(update={"seed": 4}))).isdisjoint(trials)


@pytest.mark.parametrize("search", ["random", "sobol"])
@pytest.mark.parametrize("space", [RANGES, NETWORKS | {"seed": tuple(range(20))}])
def test_a_draw_more_leaves_those_before_it(search, space):
    few, more = (expand(FieldSweep(search=search, draws=draws, spaces=(space,))) for draws in (5, 23))
    assert more[:5] == few
    both = expand(FieldSweep(search=search, draws=5, spaces=(space, POLYNOMIALS)))
    assert both[:5] == few


@pytest.mark.parametrize("search", ["random", "sobol"])
def test_a_range_too_narrow_for_the_draws_is_refused(search):
    """Drawn numbers have six digits: here there are three of them."""
    network = {"architecture": "hnn", "hidden": [[8]], "activation": ["elu"], "optimiser": ["adam"]}
    network |= {"batch_size": [64], "learning_rate": {"low": 0.1, "high": 0.100002}}
    assert len(expand(FieldSweep(search=search, draws=3, spaces=[network]))) == 3
    with pytest.raises(ValueError, match="draws: 4 is not allowed; allowed: at most 3, "):
        expand(FieldSweep(search=search, draws=4, spaces=[network]))


def test_a_sobol_sequence_is_even_where_chance_is_not():
    """Of 64 points every sixteenth of a dimension holds four."""

    def most(search):
        trials = expand(FieldSweep(search=search, draws=64, spaces=(RANGES,)))
        decades = np.log10([trial.learning_rate for trial in trials]) + 4.0
        return np.bincount((decades / 3.0 * 16.0).astype(int), minlength=16).max()

    assert most("sobol") <= 5 < most("random")


def test_a_range_of_no_more_whole_numbers_than_draws_gives_all_of_them():
    space = POLYNOMIALS | {"degree": {"low": 2, "high": 6}}
    trials = expand(FieldSweep(search="sobol", draws=5, spaces=(space,)))
    assert [trial.degree for trial in trials] == [2, 3, 4, 5, 6]
    widths = {"architecture": "hnn", "hidden": {"low": 3, "high": 4}, "activation": ["elu"]}
    assert [trial.hidden for trial in expand(FieldSweep(search="random", draws=9, spaces=(widths,)))] == [
        (3,),
        (4,),
    ]


@pytest.mark.parametrize(("scale", "room"), [("linear", [1.0] * 4), ("log", np.diff(np.log(range(1, 6))))])
def test_a_whole_number_is_drawn_as_often_as_it_has_room(scale, room):
    degree = WholeRange(low=1, high=4, scale=scale)
    drawn = np.bincount([degree.at(share) for share in np.arange(1000) / 1000.0], minlength=5)
    np.testing.assert_allclose(drawn[1:] / 1000.0, room / np.sum(room), atol=2e-3)


def test_keywords_of_ones_own_network_have_ranges_too():
    options = {
        "width": {"low": 2, "high": 9, "integer": True},
        "gain": {"low": 0.1, "high": 10, "scale": "log"},
    }
    trials = expand(FieldSweep(search="sobol", draws=8, spaces=[{"architecture": OWN, "options": options}]))
    assert all(isinstance(trial.options["width"], int) for trial in trials)
    assert {trial.options["width"] for trial in trials} == set(range(2, 10))
    assert all(0.1 <= trial.options["gain"] <= 10.0 for trial in trials)


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
    assert "spaces[1] (" in str(caught.value)
    assert f"architecture: {space['architecture']}" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_run_ids_name_their_content():
    trials = expand(FieldSweep(spaces=(NETWORKS, POLYNOMIALS)))
    ids = {run_id(t, *of) for t in trials for of in itertools.product("ab", "xy", ("data", "others"))}
    assert len(ids) == 8 * len(trials)
    assert all(re.fullmatch(r"(hnn|polynomial)-[0-9a-f]{10}", name) for name in ids)


def test_run_ids_do_not_change_unnoticed():
    """A change of these names reruns every run there is: intended, or a mistake."""
    network = trial_of(architecture="hnn", hidden=(8,), activation="elu")
    assert run_id(network, "cantilever", "hamiltonian", "0123456789abcdef") == "hnn-325f28cf81"
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
            {"architecture": "even_hnn", "hidden": (8,), "activation": "elu", "device": "cpu"},
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


def test_when_to_give_up_is_a_setting_like_any_other():
    rules = ({"after_epochs": 5, "above_nmse": 0.5}, {"after_epochs": 9, "above_nmse": 0.5})
    trials = expand(FieldSweep(spaces=(NETWORKS | {"give_up": rules},)))
    assert len(trials) == 2 * len(expand(FieldSweep(spaces=(NETWORKS,))))
    assert len({run_id(trial, "s", "v", "d") for trial in trials}) == len(trials)
    assert str(trials[0].give_up) == "after 5 epochs above 0.5"
    assert trial_of(**trials[0].model_dump(mode="json")) == trials[0]
    with pytest.raises(ValueError, match="give_up does nothing with least_squares"):
        trial_of(architecture="polynomial", degree=4, optimiser="least_squares", give_up=rules[0])


def test_every_setting_of_a_trial_is_recorded():
    trial = trial_of(architecture="network", hidden=(5,), activation="tanh", sampling="sobol")
    settings = settings_of(trial)
    assert {key: settings[key] for key in trial.model_dump()} == trial.model_dump(mode="json")
    assert settings.keys() == dimensions(MAPS).keys()
    assert settings["learning_rate"] is None


def test_no_map_is_called_as_a_field():
    assert not {*named(FIELDS, "architecture")} & {*named(MAPS, "architecture")}
