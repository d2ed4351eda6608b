"""A network of the user's own, a torch module, as a surrogate."""

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
import torch
from torch import nn

from flexsurr.config.own_network import OwnNetwork
from flexsurr.simulation.python_kernel import PythonEquations
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.program import Program
from flexsurr.surrogates.scaling import StateScaling, scaled_kernel, scaled_states
from flexsurr.surrogates.surrogate import Surrogate
from flexsurr.surrogates.torch_module import Source, Structure, field, weights_of
from flexsurr.surrogates.torch_program import NotExportable, program_of

log = logging.getLogger(__name__)

STATE = "state/"


@dataclass(frozen=True, eq=False)
class TorchSurrogate(Surrogate):
    """The field of a torch module, evaluated by torch in double precision on the CPU.

    `parameters` are the weights that were trained, one after the other as `module.parameters()` has them;
    `fixed` is whatever else its state_dict holds.
    """

    source: Source
    structure: Structure
    fixed: Mapping[str, np.ndarray]

    architecture: ClassVar[str] = "torch"

    @cached_property
    def module(self) -> nn.Module:
        """The module with these weights, which no longer ask for gradients."""
        module = self.source.build(len(self.state_names)).double()
        kept = {name: torch.from_numpy(np.array(value)) for name, value in self.fixed.items()}
        module.load_state_dict(kept, strict=False)
        nn.utils.vector_to_parameters(torch.from_numpy(self.parameters.copy()), weights_of(module))
        return module.requires_grad_(False).eval()

    @property
    def parameter_count(self) -> int:
        """The weights that were trained; as many as there are, for the module says how many."""
        return self.parameters.size

    def scaled_field(self, x: Array) -> Array:
        """The field of the module."""
        flat = torch.from_numpy(np.ascontiguousarray(x.reshape(-1, x.shape[-1])))
        return np.asarray(field(self.module, flat).detach().numpy()).reshape(x.shape)

    @cached_property
    def exported(self) -> Program | NotExportable:
        """The scaled field as a program, or why the module has none."""
        try:
            return program_of(self.module, len(self.state_names))
        except NotExportable as reason:
            log.info("%s runs in torch alone: %s", self.source.network, reason)
            return reason

    @property
    def program(self) -> Program | None:
        """The scaled field, exported; None where the module does what a program cannot do."""
        return self.exported if isinstance(self.exported, Program) else None

    @cached_property
    def _in_python(self) -> PythonEquations:
        return PythonEquations(len(self.state_names), lambda x: self.derivative(0.0, x))

    def kernel(self) -> tuple[NamedTuple, int]:
        """The program, its scales applied to inputs and outputs, or else torch, called from compiled code."""
        if self.program is None:
            return self._in_python.kernel, 0
        return scaled_kernel(self.program, 0, self.scaling, len(self.state_names))

    def settings(self) -> dict[str, Any]:
        """The file, its hash, the class and what that was made with."""
        file, name = self.source.network
        return {
            "file": file,
            "class": name,
            "sha256": self.source.sha256,
            "options": dict(self.source.options),
            "seed": self.source.seed,
            "structure": self.structure,
        }

    def arrays_to_keep(self) -> dict[str, np.ndarray]:
        """The state_dict by name."""
        return {f"{STATE}{name}": value.numpy() for name, value in self.module.state_dict().items()}


class TorchHamiltonian(TorchSurrogate):
    """The same of a module that gives H, or H and D."""

    def energy(self, x: Array) -> Array:
        """H(x) − H(0), (..., 2r) -> (...), in the product of the units of q and p per second.

        Where the scaling is not canonical, the states' equations are not Hamilton's of this energy.
        """
        origin = np.zeros((1, x.shape[-1]))
        scaled = scaled_states(self.scaling, np.concatenate([x.reshape(-1, x.shape[-1]), origin]))
        given = self.module(torch.from_numpy(scaled))
        scalar = given[0] if isinstance(given, tuple) else given
        energy = scalar.detach().numpy().reshape(-1)
        return np.asarray(self.scaling.energy * (energy[:-1] - energy[-1])).reshape(x.shape[:-1])


def torch_surrogate(
    source: Source,
    module: nn.Module,
    structure: Structure,
    scaling: StateScaling,
    state_names: tuple[str, ...],
    state_units: tuple[str, ...],
) -> TorchSurrogate:
    """The surrogate with the weights of `module`, which `source` makes, and which stands for `structure`."""
    form = TorchSurrogate if structure == "rates" else TorchHamiltonian
    with torch.no_grad():
        parameters = nn.utils.parameters_to_vector(weights_of(module)).double().cpu().numpy()
    trained = {name for name, parameter in module.named_parameters() if parameter.requires_grad}
    state = module.state_dict()
    fixed = {name: value.cpu().numpy() for name, value in state.items() if name not in trained}
    return form(parameters, scaling, state_names, state_units, source, structure, fixed)


def saved_torch_surrogate(
    header: Mapping[str, Any],
    arrays: Mapping[str, np.ndarray],
    scaling: StateScaling,
    state_names: tuple[str, ...],
    state_units: tuple[str, ...],
) -> TorchSurrogate:
    """The surrogate of a file. Raises ConfigurationError where its module is missing or has changed."""
    network = OwnNetwork(header["file"], header["class"])
    source = Source(network, header["sha256"], header["options"], header["seed"])
    module = source.build(len(state_names)).double()
    state = {
        name.removeprefix(STATE): torch.from_numpy(array)
        for name, array in arrays.items()
        if name.startswith(STATE)
    }
    try:
        module.load_state_dict(state)
    except RuntimeError as error:
        raise ValueError(" ".join(str(error).split())) from None
    return torch_surrogate(source, module, header["structure"], scaling, state_names, state_units)
