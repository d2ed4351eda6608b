"""Networks as torch modules, the user's own among them: the field that one stands for, and the checks of it.

A module maps scaled states (batch, 2r) to scaled rates (batch, 2r), or to a scalar H (batch, 1) or (batch,),
of which Hamilton's equations are made, or to two of them, (H, D), to which the gradient of D is added. What
it returns says which.
"""

import hashlib
import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

import torch
from torch import Tensor, nn

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.own_network import OwnNetwork, check_source, read_source, sha256

Structure = Literal["rates", "hamiltonian", "dissipative"]

EXPECTED = (
    "forward takes scaled states (batch, 2r), here 2r = {states}, and returns rates (batch, 2r), "
    "a scalar H (batch, 1) or (batch,), or two scalars (H, D)"
)


def field(module: Callable[[Tensor], Any], x: Tensor, create_graph: bool = False) -> Tensor:
    """The scaled field (batch, 2r) of `module` at scaled states `x` (batch, 2r).

    With `create_graph` its derivatives by the weights can be taken.
    """
    with torch.enable_grad():
        x = x if x.requires_grad else x.detach().requires_grad_()
        given = module(x)
        if isinstance(given, Tensor) and given.shape == x.shape:
            return given
        scalars = (given,) if isinstance(given, Tensor) else given
        gradients = [_gradient(scalar, x, create_graph) for scalar in scalars]
        by_q, by_p = gradients[0].chunk(2, dim=-1)
        hamiltons = torch.cat([by_p, -by_q], dim=-1)
        return hamiltons + gradients[1] if len(gradients) == 2 else hamiltons


def _gradient(scalar: Tensor, x: Tensor, create_graph: bool) -> Tensor:
    (gradient,) = torch.autograd.grad(scalar.sum(), x, create_graph=create_graph, retain_graph=True)
    return gradient


def weights_of(module: nn.Module) -> list[nn.Parameter]:
    """The parameters that training changes."""
    return [parameter for parameter in module.parameters() if parameter.requires_grad]


@dataclass(frozen=True)
class Source:
    """The class of a network of the user's own, its file's hash, and what it is made with.

    That is keywords, and a seed of torch's generator, from which it draws its weights.
    """

    network: OwnNetwork
    sha256: str
    options: Mapping[str, Any]
    seed: int = 0

    def build(self, states: int, root: Path | None = None) -> nn.Module:
        """The module for `states` = 2r states.

        This runs the file, which lies below `root` (by default the current folder). Raises
        ConfigurationError, of one line, where it is missing or has changed, and where the class does not take
        these options or is no torch module.
        """
        torch.set_num_threads(1)  # a trial is a job among others
        form = self._form(root or Path())
        options = {"states": states, **self.options}
        try:
            inspect.signature(form).bind(**options)
        except TypeError as error:
            taken = ", ".join(inspect.signature(form).parameters)
            raise self._refused(f"{error} (given: {', '.join(options)}; it takes: {taken})") from None
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(self.seed)
            try:
                module: nn.Module = form(**options)
            except Exception as error:
                raise self._refused(f"{_place(error)} in its constructor") from error
        return module

    def _form(self, root: Path) -> type[nn.Module]:
        try:
            source = read_source(root, self.network)
            if sha256(source) != self.sha256:
                raise ValueError(
                    f"{self.network}: {self.network.file} has changed since this run was named (its hash was "
                    f"{self.sha256[:10]}…); run the sweep again, or put the file back"
                )
            check_source(self.network, source)
        except ValueError as error:
            raise ConfigurationError([str(error)]) from None
        # under a name of its own content: one that has changed is run anew
        name = f"flexsurr_own_{hashlib.sha256(repr((self.network.file, self.sha256)).encode()).hexdigest()}"
        if name not in sys.modules:
            path = (root / self.network.file).resolve()
            holder = ModuleType(name)
            holder.__file__ = str(path)
            sys.modules[name] = holder
            try:
                exec(compile(source, path, "exec"), holder.__dict__)
            except Exception as error:
                del sys.modules[name]
                raise self._refused(f"{_place(error)} when the file was run") from error
        form = getattr(sys.modules[name], self.network.name)
        if not (isinstance(form, type) and issubclass(form, nn.Module)):
            raise self._refused("not a torch.nn.Module")
        return form

    def _refused(self, reason: str) -> ConfigurationError:
        return ConfigurationError([f"{self.network}: {reason}"])


def checked(what: object, module: nn.Module, x: Tensor) -> Structure:
    """What `module` stands for, tried on scaled states `x` (m, 2r), m > 1, of its precision and device.

    Raises ConfigurationError, of one line that begins with `what`, where its forward does not do what
    training and simulation ask of it.
    """

    def refused(reason: str) -> ConfigurationError:
        return ConfigurationError([f"{what}: {reason}; {EXPECTED.format(states=x.shape[1])}"])

    before = {name: value.clone() for name, value in _state(module, refused).items()}
    for batch in (x, x[:1]):
        try:
            given = module(batch.clone().requires_grad_())
        except Exception as error:
            raise refused(f"{_place(error)} in forward, at states {tuple(batch.shape)}") from error
        structure = _structure(given, batch, refused)
    try:
        rates = field(module, x, create_graph=True)
    except RuntimeError as error:
        raise refused(f"H has no gradient by the states ({_line(error)})") from error
    if not torch.isfinite(rates).all():
        raise refused("not a finite number at states of the training data")
    if not (weights := weights_of(module)):
        raise refused("no parameters to train")
    if all(gradient is None for gradient in torch.autograd.grad(rates.sum(), weights, allow_unused=True)):
        raise refused(
            "what forward returns does not depend on any weight for autograd (torch.autograd.grad within it "
            "takes create_graph=True)"
        )
    if any(not torch.equal(value, before[name]) for name, value in _state(module, refused).items()):
        raise refused("forward changes its buffers, as batch normalisation does; allowed: fixed ones")
    return structure


def _structure(given: Any, x: Tensor, refused: Any) -> Structure:
    scalars = given if isinstance(given, tuple) else (given,)
    for part in scalars:
        if not isinstance(part, Tensor):
            raise refused(f"forward returned {type(part).__name__}")
        if part.dtype != x.dtype:
            raise refused(f"forward returned {part.dtype} for states of {x.dtype}")
    if isinstance(given, Tensor) and given.shape == x.shape:
        return "rates"
    shapes = [tuple(part.shape) for part in scalars]
    if len(scalars) not in (1, 2) or any(shape not in ((len(x), 1), (len(x),)) for shape in shapes):
        found = " and ".join(map(str, shapes)) or "nothing"
        raise refused(f"forward returned {found} for states {tuple(x.shape)}")
    return "hamiltonian" if len(scalars) == 1 else "dissipative"


def _state(module: nn.Module, refused: Any) -> Mapping[str, Tensor]:
    state = module.state_dict()
    for name, value in state.items():
        if not isinstance(value, Tensor):
            raise refused(f"{name} in its state_dict is no tensor")
        if nn.parameter.is_lazy(value) or value.is_complex():
            raise refused(f"{name} has no size yet, or is complex; allowed: real numbers, sized at once")
        if not torch.isfinite(value).all():
            raise refused(f"{name} is not finite")
    return state


def _place(error: Exception) -> str:
    """The error in one line, with the last line of a file that is not torch's."""
    traceback, line = error.__traceback__, None
    while traceback is not None:
        if "flexsurr_own_" in traceback.tb_frame.f_globals.get("__name__", ""):
            line = traceback.tb_lineno
        traceback = traceback.tb_next
    return f"{type(error).__name__}: {_line(error)}" + (f" (line {line})" if line else "")


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
