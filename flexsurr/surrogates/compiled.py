"""The compiled form of a surrogate: the same states and equations, for compiled integrators."""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from flexsurr.simulation.rhs import Array, evaluate
from flexsurr.surrogates.surrogate import Hamiltonian, Surrogate


@dataclass(frozen=True, eq=False)
class CompiledSurrogate:
    """A CompiledModel; `surrogate` is what it was made from."""

    surrogate: Surrogate
    kernel: NamedTuple
    work_size: int
    breakpoints: ClassVar[tuple[float, ...]] = ()

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the states, those of the surrogate."""
        return self.surrogate.state_names

    @property
    def state_units(self) -> tuple[str, ...]:
        """Units of the states, those of the surrogate."""
        return self.surrogate.state_units

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at the state `x` (2r,), through the compiled kernel."""
        dx = np.empty(len(self.state_names))
        evaluate(self.kernel, t, np.ascontiguousarray(x, dtype=np.float64), dx, np.empty(self.work_size))
        return dx


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
