"""Torch modules as compiled integrators step them: exported as programs, or called where they cannot be."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import torch
from own_models import Energy, EnergyAndDissipation, Lagrangian, MessagePassing, Plain
from torch import nn

from flexsurr.config.own_network import OwnNetwork, sha256
from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate
from flexsurr.simulation.rhs import evaluate
from flexsurr.surrogates import FeatureScaling, Scaling, compiled
from flexsurr.surrogates.torch_module import Source, checked, field
from flexsurr.surrogates.torch_program import NotExportable, program_of
from flexsurr.surrogates.torch_surrogate import torch_surrogate

FORMS = (Plain, Energy, EnergyAndDissipation, Lagrangian, MessagePassing)
ELEMENTWISE = (
    torch.tanh, torch.sigmoid, torch.sin, torch.cos, torch.atan, torch.exp, torch.erf, torch.relu, torch.abs,
    torch.sqrt, torch.log, torch.log1p, torch.expm1, torch.reciprocal, torch.rsqrt, torch.square,
    nn.functional.softplus, nn.functional.silu, nn.functional.gelu, nn.functional.elu, nn.functional.mish,
    nn.functional.leaky_relu, nn.functional.hardtanh, nn.functional.logsigmoid,
)  # fmt: skip


class Of(nn.Module):
    """Rates of a given function of a linear map."""

    def __init__(self, states, function):
        super().__init__()
        self.linear = nn.Linear(states, states)
        self.function = function

    def forward(self, x):
        return self.function(self.linear(x))


def module_of(form, *arguments):
    torch.manual_seed(0)
    return form(*arguments).double().requires_grad_(False).eval()


def differs(module, states, scale=1.0):
    """The largest difference of the program from the module at random states, over the largest rate."""
    x = scale * np.random.default_rng(1).normal(size=(50, states))
    expected = field(module, torch.from_numpy(x)).detach().numpy()
    program, found = program_of(module, states), np.empty_like(expected)
    for state, rates in zip(x, found, strict=True):
        evaluate(program, 0.0, state, rates, np.empty(0))
    within = np.isfinite(expected)
    return np.abs(found - expected)[within].max() / np.abs(expected[within]).max()


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("states", [2, 4, 6])
def test_a_program_is_its_module(form, states):
    assert differs(module_of(form, states), states) < 1e-12


@pytest.mark.parametrize("function", ELEMENTWISE)
def test_every_function_of_numbers_is_torchs(function):
    assert differs(module_of(Of, 4, function), 4, scale=3.0) < 1e-12


MOVED = {
    "softmax": lambda x: torch.softmax(x, dim=1),
    "norm": lambda x: x / (1.0 + x.norm(dim=1, keepdim=True)),
    "layer norm": lambda x: nn.functional.layer_norm(x, (4,)),
    "outer": lambda x: torch.einsum("bi,bj->bij", x, x).mean(dim=2),
    "lower": lambda x: torch.einsum("bij,bj->bi", torch.tril(x[:, :, None] + x[:, None, :]), x),
    "stack": lambda x: torch.stack([x[:, 3], x[:, 1] * x[:, 0], x[:, 2], x.sum(dim=1)], dim=1),
    "clamp": lambda x: x.clamp(-0.5, 0.25) ** 3,
    "where": lambda x: torch.where(x > 0.1, x, 0.1 * x.flip(1)),
    "turned": lambda x: (x.reshape(-1, 2, 2).transpose(1, 2) @ x.reshape(-1, 2, 2)).reshape(-1, 4),
    "largest": lambda x: x - x.amax(dim=1, keepdim=True),
    "cumulated": lambda x: x @ torch.triu(torch.ones(4, 4, dtype=x.dtype)),
    "by index": lambda x: x[:, [2, 0, 3, 3]] * x[:, 1:2],
}


@pytest.mark.parametrize("name", MOVED)
def test_what_moves_numbers_moves_them_as_torch_does(name):
    assert differs(module_of(Of, 4, MOVED[name]), 4) < 1e-12


@pytest.mark.parametrize(
    ("function", "reason"),
    [
        (lambda x: x if x.sum() > 0.0 else -x, "."),
        (lambda x: torch.linalg.eigvalsh(x[:, :, None] * x[:, None, :]), "eigh"),
        (lambda x: torch.special.bessel_j0(x), "bessel"),
    ],
)
def test_what_cannot_be_exported_is_said(function, reason):
    with pytest.raises(NotExportable, match=reason):
        program_of(module_of(Of, 4, function), 4)


def surrogate_of(form, scaling=None, **changes):
    """The surrogate of a class of own_models.py, with random weights."""
    network = OwnNetwork("own_models.py", form.__name__)
    source = Source(network, sha256(Path("own_models.py").read_bytes()), {})
    module = source.build(2).double()
    structure = checked(network, module, torch.ones(3, 2, dtype=torch.float64))
    scaling = scaling or Scaling(q=0.5, p=2.0, energy=3.0)
    return torch_surrogate(source, module, structure, scaling, ("q", "p"), ("1", "1"))


@pytest.fixture(autouse=True)
def project(tmp_path, monkeypatch):
    shutil.copy(Path(__file__).with_name("own_models.py"), tmp_path)
    monkeypatch.chdir(tmp_path)


SCALINGS = (Scaling(q=0.5, p=2.0, energy=3.0), FeatureScaling((0.5, 2.0), (1.0, 0.1)))
X0, T = np.array([0.3, 0.1]), np.linspace(0.0, 1.0, 6)


@pytest.mark.parametrize("scaling", SCALINGS)
@pytest.mark.parametrize("exported", [True, False])
@pytest.mark.parametrize("method", ["dop853", "radau_iia_5"])
def test_compiled_integrators_step_it_as_scipys_do(scaling, exported, method):
    surrogate = surrogate_of(Energy, scaling)
    if not exported:
        surrogate.__dict__["exported"] = NotExportable("for this test")
    tight = {"rtol": 1e-9, "atol": 1e-11}
    expected = simulate(surrogate, T, X0, Integrator(method="scipy_dop853", **tight))
    found = simulate(compiled(surrogate), T, X0, Integrator(method=method, **tight))
    assert found.completed
    np.testing.assert_allclose(found.x, expected.x, rtol=1e-6, atol=1e-8)


def called_from_compiled_code(monkeypatch, raised):
    """A simulation of a network that raises when it is called for the tenth time."""
    surrogate = surrogate_of(Energy)
    surrogate.__dict__["exported"] = NotExportable("for this test")
    model, calls = compiled(surrogate), []

    def interrupted(module, x):
        calls.append(x)
        if len(calls) > 9:
            raise raised
        return field(module, x)

    monkeypatch.setattr("flexsurr.surrogates.torch_surrogate.field", interrupted)
    return simulate(model, T, X0, Integrator(method="dop853"))


def test_ctrl_c_within_a_network_ends_the_simulation(monkeypatch):
    with pytest.raises(KeyboardInterrupt):
        called_from_compiled_code(monkeypatch, KeyboardInterrupt)
    monkeypatch.setattr("flexsurr.surrogates.torch_surrogate.field", field)
    assert simulate(compiled(surrogate_of(Plain)), T, X0, Integrator(method="dop853")).completed


def test_an_error_within_a_network_ends_its_trajectory(monkeypatch):
    trajectory = called_from_compiled_code(monkeypatch, RuntimeError("singular"))
    assert not trajectory.completed
    assert "finite" in trajectory.reason
