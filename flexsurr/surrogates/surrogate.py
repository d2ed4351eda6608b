"""What every surrogate is: a right-hand side ẋ = f(x) learned in scaled states, and its compiled form."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Protocol, runtime_checkable

import numpy as np

from flexsurr.simulation.rhs import Array, ByKernel
from flexsurr.surrogates.scaling import StateScaling, rates_of, scaled_states


@dataclass(frozen=True, eq=False)
class Surrogate(ABC):
    """An autonomous model of the states x = (q, p) in plain NumPy; `compiled` gives its fast form.

    `parameters` are its weights in one vector. A subclass is a field of the *scaled* states, from
    (..., 2r) to (..., 2r); scaling and units are dealt with here. Unless it is `paired` it takes any states.
    """

    parameters: Array
    scaling: StateScaling
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]

    architecture: ClassVar[str]
    paired: ClassVar[bool] = True
    breakpoints: ClassVar[tuple[float, ...]] = ()

    def __post_init__(self) -> None:
        if len(self.state_names) != len(self.state_units) or (self.paired and len(self.state_names) % 2):
            pairs = "pairs (q, p)" if self.paired else "any number"
            raise ValueError(
                f"states come in {pairs} with a unit each, not {self.state_names} in {self.state_units}"
            )
        if self.parameters.shape != (self.parameter_count,):
            raise ValueError(
                f"this {self.architecture} has {self.parameter_count} parameters,"
                f" not an array of shape {self.parameters.shape}"
            )

    @property
    @abstractmethod
    def parameter_count(self) -> int:
        """Number of parameters that the architecture asks for."""

    @abstractmethod
    def scaled_field(self, x: Array) -> Array:
        """The scaled states' derivatives with respect to the scaled time, (..., 2r) -> (..., 2r)."""

    @abstractmethod
    def kernel(self) -> tuple[NamedTuple, int]:
        """The compiled form, scales folded in, and the size of its workspace."""

    @abstractmethod
    def settings(self) -> dict[str, Any]:
        """What, besides parameters, scaling and states, makes this surrogate; plain JSON values."""

    def arrays_to_keep(self) -> dict[str, np.ndarray]:
        """The arrays that make this surrogate, by the names they have in its file."""
        return {"parameters": self.parameters}

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (..., 2r) at states `x` (..., 2r), in the units of the states per second."""
        return rates_of(self.scaling, self.scaled_field(scaled_states(self.scaling, x)))


@runtime_checkable
class Hamiltonian(Protocol):
    """Anything that knows its energy."""

    def energy(self, x: Array) -> Array:
        """H(x) − H(0), (..., 2r) -> (...), in the product of the units of q and p per second."""
        ...


def symplectic(gradient: Array) -> Array:
    """(∂H/∂q, ∂H/∂p) -> (∂H/∂p, −∂H/∂q), both (..., 2r): Hamilton's equations."""
    r = gradient.shape[-1] // 2
    return np.concatenate([gradient[..., r:], -gradient[..., :r]], axis=-1)


@dataclass(frozen=True, eq=False)
class FormOfSurrogate:
    """A Model by other code than that of the `surrogate` it was made from."""

    surrogate: Surrogate
    breakpoints: ClassVar[tuple[float, ...]] = ()

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the states, those of the surrogate."""
        return self.surrogate.state_names

    @property
    def state_units(self) -> tuple[str, ...]:
        """Units of the states, those of the surrogate."""
        return self.surrogate.state_units


@dataclass(frozen=True, eq=False)
class CompiledSurrogate(ByKernel, FormOfSurrogate):
    """A CompiledModel."""

    kernel: NamedTuple
    work_size: int


@dataclass(frozen=True, eq=False)
class CompiledHamiltonian(CompiledSurrogate):
    """The compiled form of a surrogate that knows its energy."""

    def energy(self, x: Array) -> Array:
        """H(x) − H(0), (..., 2r) -> (...), as the surrogate has it."""
        assert isinstance(self.surrogate, Hamiltonian)
        return self.surrogate.energy(x)


def compiled(surrogate: Surrogate) -> CompiledSurrogate:
    """The compiled form of `surrogate`."""
    form = CompiledHamiltonian if isinstance(surrogate, Hamiltonian) else CompiledSurrogate
    return form(surrogate, *surrogate.kernel())
