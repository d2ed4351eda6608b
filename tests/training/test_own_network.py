"""Networks of the user's own: the loss is that of the compiled form, and they train like any other."""

import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import torch
from oscillator import free_responses, network, three_pairs

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.own_network import own_network, sha256
from flexsurr.config.study import Integrator
from flexsurr.config.trial import trial_of
from flexsurr.simulation import simulate
from flexsurr.surrogates import Hamiltonian, compiled, load, save
from flexsurr.training import fit, lbfgs, nmse, split_dataset
from flexsurr.training.adam import Adam
from flexsurr.training.networks import from_torch, to_torch
from flexsurr.training.objective import Objective
from flexsurr.training.torch_training import (
    CPU,
    TorchAdam,
    TorchObjective,
    begun_on,
    device_of,
    objective_of,
    source_of,
    untrained,
)

MODELS = Path(__file__).with_name("own_models.py")
FILE = "models/own_models.py"
DATASET = free_responses()
LBFGS = trial_of(architecture=f"{FILE}:Energy", epochs=25)
ADAM = trial_of(
    architecture=f"{FILE}:Plain", optimiser="adamw_cosine", epochs=25, batch_size=32, learning_rate=0.02
)
SINGLE = trial_of(
    architecture=f"{FILE}:Plain",
    optimiser="adam",
    epochs=25,
    batch_size=32,
    learning_rate=0.02,
    precision="single",
)


def chain(samples=240, seed=0):
    """Three masses in a row between springs, at random states."""
    x = np.random.default_rng(seed).normal(size=(samples, 6))
    stiffness = 2.0 * np.eye(3) - np.eye(3, k=1) - np.eye(3, k=-1)
    names = tuple(f"{kind}_{k}" for kind in ("eta", "p") for k in range(3))
    return split_dataset(
        np.arange(samples) % 4,
        x,
        np.concatenate([x[:, 3:], -x[:, :3] @ stiffness], axis=1),
        validation=[0],
        state_names=names,
        state_units=("1",) * 6,
    )


CLASSES = ("Plain", "Energy", "EnergyAndDissipation", "Lagrangian", "MessagePassing")


@pytest.fixture(autouse=True)
def project(tmp_path, monkeypatch):
    """The current folder, with the file of models below it."""
    (tmp_path / "models").mkdir()
    shutil.copy(MODELS, tmp_path / FILE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def objectives(architecture, hidden, dataset, minimised="nmse"):
    """The compiled form's and the torch module's, of the same network."""
    surrogate = network(dataset, architecture, hidden)
    ours = replace(Objective.of(surrogate, dataset.x_train, dataset.dx_train), minimised=minimised)
    return ours, TorchObjective(to_torch(surrogate), ours.x, ours.y, minimised)


def in_our_order(objective, parameters):
    """Weights, or a gradient, of the torch module in the layout of the compiled form."""
    module = to_torch(objective.network)
    torch.nn.utils.vector_to_parameters(torch.from_numpy(parameters.copy()), module.parameters())
    return from_torch(module, objective.network).parameters


@pytest.mark.parametrize("minimised", ["nmse", "mean_square", "norms"])
@pytest.mark.parametrize(
    ("architecture", "hidden"), [("mlp", (5,)), ("hnn", (4, 3)), ("dissipative_hnn", (4, 3))]
)
def test_loss_and_gradient_are_those_of_the_compiled_form(architecture, hidden, minimised):
    ours, torchs = objectives(architecture, hidden, three_pairs(), minimised)
    assert torchs.loss(torchs.parameters) == pytest.approx(ours.loss(ours.network.parameters), rel=1e-12)
    for samples in (None, np.array([3, 11, 4])):
        expected = np.empty(ours.network.parameter_count)
        loss = ours.gradient(ours.network.parameters, expected, samples)
        found = np.empty_like(expected)
        assert torchs.gradient(torchs.parameters, found, samples) == pytest.approx(loss, rel=1e-12)
        found = in_our_order(ours, found)
        np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12 * np.abs(expected).max())


def test_a_plain_network_of_ones_own_is_flexsurrs_mlp():
    """The same weights in both: the same field, loss and gradient."""
    ours, torchs = objectives("mlp", (6,), DATASET)
    mlp = replace(ours.network, activation="tanh")
    ours = replace(ours, network=mlp)
    source = source_of(own_network(f"{FILE}:Plain"), "", {}, 0)
    surrogate = replace(untrained(source, DATASET, mlp.scaling), parameters=torchs.parameters)
    np.testing.assert_allclose(
        surrogate.derivative(0.0, DATASET.x_train),
        mlp.derivative(0.0, DATASET.x_train),
        rtol=1e-12,
        atol=1e-12,
    )
    found, expected = np.empty((2, mlp.parameter_count))
    objective = objective_of(surrogate, DATASET.x_train, DATASET.dx_train)
    loss = objective.gradient(surrogate.parameters, found)
    assert loss == pytest.approx(ours.gradient(mlp.parameters, expected), rel=1e-12)
    np.testing.assert_allclose(in_our_order(ours, found), expected, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("decay", [None, 0.3])
def test_adam_takes_the_steps_of_the_compiled_one(decay):
    ours, torchs = objectives("hnn", (8,), DATASET)
    settings = {"learning_rate": 3e-3, "batch_size": 16, "epochs": 4, "cosine": True, "seed": 0}
    reference = Adam(ours, ours.network.parameters, **settings, weight_decay=decay or 0.0, precision="double")
    optimiser = TorchAdam(torchs, **settings, weight_decay=decay)
    for _ in range(4):
        assert optimiser.epoch() == pytest.approx(reference.epoch(), rel=1e-9)
    found = in_our_order(ours, optimiser.parameters)
    np.testing.assert_allclose(found, reference.parameters, rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("architecture", ["mlp", "hnn", "dissipative_hnn"])
def test_on_a_device_networks_of_flexsurr_take_the_steps_of_their_compiled_form(architecture):
    settings = {"architecture": architecture, "hidden": (4, 3), "activation": "atan", "device": "auto"}
    steps = {"learning_rate": 3e-3, "batch_size": 16, "epochs": 3}
    surrogate = network(DATASET, architecture, (4, 3))
    ours = Objective.of(surrogate, DATASET.x_train, DATASET.dx_train)
    trial = trial_of(**settings, **steps, optimiser="adam_cosine")
    _, training, validation, optimiser = begun_on(CPU, trial, surrogate, DATASET)
    reference = Adam(
        ours, surrogate.parameters, **steps, cosine=True, seed=0, weight_decay=0.0, precision="double"
    )
    for _ in range(3):
        assert optimiser.epoch() == pytest.approx(reference.epoch(), rel=1e-9)
    np.testing.assert_allclose(optimiser.parameters, reference.parameters, rtol=1e-9, atol=1e-11)
    held_out = Objective.of(surrogate, DATASET.x_validation, DATASET.dx_validation)
    for objective, expected in ((training, ours), (validation, held_out)):
        loss = expected.loss(reference.parameters)
        assert objective.loss(reference.parameters) == pytest.approx(loss, rel=1e-9)
    trial = trial_of(**settings, optimiser="lbfgs", epochs=3)
    *_, optimiser = begun_on(CPU, trial, surrogate, DATASET)
    reference = lbfgs.LBFGS(ours, surrogate.parameters)
    for _ in range(3):
        assert optimiser.epoch() == pytest.approx(reference.epoch(), rel=1e-8)
    np.testing.assert_allclose(optimiser.parameters, reference.parameters, rtol=1e-7, atol=1e-9)


def test_without_a_graphics_processor_auto_is_compiled_code(tmp_path, monkeypatch):
    monkeypatch.setattr("torch.cuda.is_available", lambda: False)
    hnn = {"architecture": "hnn", "hidden": (4,), "activation": "atan", "optimiser": "lbfgs", "epochs": 3}
    fits = [
        fit(trial_of(**hnn, device=device), DATASET, tmp_path / device).surrogate
        for device in ("cpu", "auto")
    ]
    np.testing.assert_array_equal(fits[0].parameters, fits[1].parameters)
    assert "device" not in trial_of(**hnn, device="cpu").model_dump()  # its runs keep their names
    with pytest.raises(ConfigurationError, match="device: cuda is not available"):
        fit(trial_of(**hnn, device="cuda"), DATASET, tmp_path / "cuda")


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        (
            {"architecture": "hnn", "hidden": (4,), "activation": "atan"},
            "levenberg_marquardt trains this hnn by compiled code, on the CPU; on a device: lbfgs, adam, ",
        ),
        (
            {"architecture": "even_hnn", "hidden": (4,), "activation": "atan"},
            "levenberg_marquardt trains this even_hnn by compiled code, on the CPU$",
        ),
        (
            {"architecture": "network", "hidden": (4,), "activation": "atan", "optimiser": "lbfgs"},
            "on the CPU$",
        ),
    ],
)
def test_what_no_device_trains_is_refused_with_its_reason(settings, why):
    with pytest.raises(ValueError, match=f"^device: .*{why}"):
        trial_of(**settings, device="cuda")


def test_losses_are_made_piece_by_piece(monkeypatch):
    _, torchs = objectives("hnn", (5,), DATASET)
    whole, found = np.empty((2, torchs.parameters.size))
    losses = torchs.loss(torchs.parameters), torchs.gradient(torchs.parameters, whole)
    monkeypatch.setattr("flexsurr.training.torch_training.PIECE", 7)
    assert torchs.loss(torchs.parameters) == pytest.approx(losses[0], rel=1e-12)
    assert torchs.gradient(torchs.parameters, found) == pytest.approx(losses[1], rel=1e-12)
    np.testing.assert_allclose(found, whole, rtol=1e-10, atol=1e-14)


@pytest.mark.parametrize("name", CLASSES)
@pytest.mark.parametrize("dataset", [DATASET, chain()], ids=["one pair", "three pairs"])
def test_what_a_fit_says_is_so_and_the_surrogate_comes_back(name, dataset, project):
    trial = LBFGS.model_copy(update={"architecture": f"{FILE}:{name}", "epochs": 8})
    result = fit(trial, dataset, project / "run")
    assert (result.status, result.reason) == ("finished", "")
    field = result.surrogate.derivative(0.0, dataset.x_validation)
    assert result.validation_nmse == pytest.approx(nmse(field, dataset.dx_validation), rel=1e-9)
    assert result.train_nmse < result.history.train_loss.iloc[0]
    assert result.parameters == result.surrogate.parameters.size
    assert isinstance(result.surrogate, Hamiltonian) == name.startswith("Energy")
    save(result.surrogate, "weights.npz")
    np.testing.assert_array_equal(load("weights.npz").derivative(0.0, dataset.x_validation), field)


def test_a_lagrangian_network_is_accurate(project):
    """M(q) and V(q) are what the oscillator has."""
    trial = LBFGS.model_copy(update={"architecture": f"{FILE}:Lagrangian", "epochs": 150})
    assert fit(trial, DATASET, project / "run").validation_nmse < 1e-3


class Killed(Exception):
    """Stands for the end of a process."""


def kill_at(epoch, done, *_):
    if done == epoch:
        raise Killed


@pytest.mark.parametrize("trial", [LBFGS, ADAM, SINGLE], ids=["lbfgs", "adamw_cosine", "adam, single"])
def test_killed_and_resumed_is_as_uninterrupted(trial, project, monkeypatch):
    expected = fit(trial, DATASET, project / "whole")
    assert expected.status == "finished"
    monkeypatch.setattr("flexsurr.training.epochs.CHECKPOINT_EVERY_S", 0.0)
    for epoch in (7, 16):
        with pytest.raises(Killed):
            fit(trial, DATASET, project / "killed", partial(kill_at, epoch))
    resumed_at = []
    found = fit(trial, DATASET, project / "killed", lambda epoch, *_: resumed_at.append(epoch))
    assert resumed_at[0] == 16
    np.testing.assert_array_equal(found.surrogate.parameters, expected.surrogate.parameters)
    losses = ["train_loss", "validation_loss"]
    np.testing.assert_array_equal(found.history[losses], expected.history[losses])


def test_seeds_and_options_make_other_networks(project):
    def weights(**changes):
        trial = ADAM.model_copy(update={"epochs": 1, **changes})
        return fit(trial, DATASET, project / "run").surrogate.parameters

    np.testing.assert_array_equal(weights(), weights())
    assert np.any(weights() != weights(seed=1))
    assert weights(options={"hidden": 9}).size > weights().size


def test_a_hamiltonian_of_ones_own_is_conserved(project):
    surrogate = fit(LBFGS, DATASET, project / "run").surrogate
    trajectory = simulate(
        compiled(surrogate),
        np.linspace(0.0, 0.2, 21),
        DATASET.x_train[0],
        Integrator(method="scipy_dop853", rtol=1e-10, atol=1e-12),
    )
    energy = surrogate.energy(trajectory.x)
    assert np.ptp(energy) < 1e-7 * np.abs(energy).max()


def written(project, body, head="import torch\nfrom torch import nn\n"):
    """A class MyField of the given constructor and forward in a file of its own."""
    (project / "mine.py").write_text(head + "class MyField(nn.Module):\n" + body)
    return trial_of(architecture="mine.py:MyField", epochs=1)


LINEAR = """
    def __init__(self, states):
        super().__init__()
        self.a = nn.Linear(states, states)
"""
REFUSED = {
    "forward returned (5, 3) for states (5, 2); forward takes": "return x.new_zeros(len(x), 3)",
    "forward returned () for states (1, 2)": "return self.a(x).sum(1).squeeze()",
    "forward returned ndarray": "return self.a(x).detach().numpy()",
    "forward returned torch.float32 for states of torch.float64": "return self.a(x).float()",
    "forward returned (5, 2) and (5, 2) for": "return self.a(x), x",
    "not a finite number at states": "return self.a(x) / 0.0",
    "RuntimeError: mat1 and mat2 shapes": "return self.a(x[:, :1])",
    "(line 9) in forward, at states (5, 2)": "return self.b(x)",
    "does not depend on any weight": "return x",
    "H has no gradient by the states": "return self.a.bias.sum() + x.new_zeros(len(x), 1)",
    "forward changes its buffers": "self.a.bias.data.add_(1.0); return self.a(x)",
}


@pytest.mark.parametrize("message", REFUSED)
def test_a_forward_that_does_not_do_is_refused_in_a_line(message, project):
    trial = written(project, f"{LINEAR}    def forward(self, x):\n        {REFUSED[message]}\n")
    with pytest.raises(ConfigurationError) as caught:
        fit(trial, DATASET, project / "run")
    assert str(caught.value).startswith("mine.py:MyField: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "body", "message"),
    [
        ({"options": {"depth": 2}}, LINEAR, "unexpected keyword argument 'depth'"),
        ({}, LINEAR.replace("states)", "states, width)", 1), "missing a required argument: 'width'"),
        ({}, LINEAR.replace("self.a", "1 / 0  # "), "ZeroDivisionError"),
        ({"device": "cuda"}, f"{LINEAR}    def forward(self, x):\n        return self.a(x)\n", "cpu, auto"),
        ({"architecture": "gone.py:MyField"}, LINEAR, "gone.py:MyField: no file gone.py below"),
        ({"architecture": "../mine.py:MyField"}, LINEAR, "lies outside the project"),
        ({"architecture": "mine.py:Yours"}, LINEAR, "defines no class Yours; allowed: MyField"),
        ({}, LINEAR + "    def (\n", "mine.py, line 8: not Python"),
    ],
)
def test_a_class_that_does_not_do_is_refused_in_a_line(changes, body, message, project):
    trial = written(project, body).model_copy(update=changes)
    with pytest.raises(ConfigurationError) as caught:
        fit(trial, DATASET, project / "run")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_is_no_torch_module_is_refused(project):
    (project / "mine.py").write_text("class MyField:\n    pass\n")
    with pytest.raises(ConfigurationError, match=r"mine\.py:MyField: not a torch\.nn\.Module"):
        fit(trial_of(architecture="mine.py:MyField"), DATASET, project / "run")


def test_a_surrogate_says_that_its_file_has_changed_or_gone(project):
    save(fit(LBFGS, DATASET, project / "run").surrogate, "weights.npz")
    path = project / FILE
    path.write_text(path.read_text() + "# another thought\n")
    with pytest.raises(ConfigurationError, match=r"models/own_models\.py has changed since"):
        load("weights.npz")
    path.unlink()
    with pytest.raises(ConfigurationError, match=r"no file models/own_models\.py below"):
        load("weights.npz")


def test_auto_is_the_cpu_where_nothing_else_is(monkeypatch):
    monkeypatch.setattr("torch.cuda.is_available", lambda: False)
    assert device_of("auto") == device_of("cpu") == torch.device("cpu")


def test_the_source_of_a_trial_is_the_file_as_it_is(project):
    source = source_of(own_network(f"{FILE}:Plain"), "", {}, 0)
    assert source.sha256 == sha256(MODELS.read_bytes())
