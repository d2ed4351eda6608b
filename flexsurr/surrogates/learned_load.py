"""Any compiled model under a load whose generalised forces are learned: no kinematics are computed.

A load of fixed shape follows one history, F(t) = s(t) f, and so do its generalised forces, s(t) Q̂(η).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from flexsurr.simulation.history import (
    History,
    HistoryKernel,
    breakpoints,
    history_factor,
    history_kernel,
)
from flexsurr.simulation.mapping import mapping
from flexsurr.simulation.rhs import Array, evaluate, implements_rhs, rhs
from flexsurr.surrogates.learned_map import LearnedMap


class LearnedLoadKernel(NamedTuple):
    """A model's kernel, that of the forces, and the history."""

    model: Any
    forces: Any
    history: HistoryKernel


@implements_rhs(LearnedLoadKernel, inline=False)
def _learned_load(kernel, t, x, dx, work):
    rhs(kernel.model, t, x, dx, work)
    factor = history_factor(kernel.history, t)
    if factor != 0.0:
        r = x.size // 2
        mapping(kernel.forces, x[:r], work[:r], work[r:])
        for i in range(r):
            dx[r + i] += factor * work[i]


@dataclass(frozen=True, eq=False)
class LearnedLoad:
    """A CompiledModel: `model`, whose states are (η, p), under a load of learned generalised forces.

    `forces` maps η (r,) to Q̂ (r,) at a factor of 1. Raises ValueError where their numbers don't fit.
    """

    model: Any  # a CompiledModel; what more it has, as an energy, is passed on
    forces: LearnedMap
    history: History

    def __post_init__(self) -> None:
        r = len(self.model.state_names) // 2
        inputs, outputs = len(self.forces.inputs.names), len(self.forces.output_names)
        if (inputs, outputs) != (r, r):
            raise ValueError(
                f"a map of {inputs} coordinates to {outputs} forces"
                f" does not fit the states {', '.join(self.model.state_names)}"
            )

    @property
    def state_names(self) -> tuple[str, ...]:
        """Those of the model."""
        names: tuple[str, ...] = self.model.state_names
        return names

    @property
    def state_units(self) -> tuple[str, ...]:
        """Those of the model."""
        units: tuple[str, ...] = self.model.state_units
        return units

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Times [s] at which the load, or the model itself, may jump."""
        return tuple(sorted({*self.model.breakpoints, *breakpoints(self.history)}))

    @property
    def energy(self) -> Any:
        """The model's own energy, without the work of the load; AttributeError where it has none."""
        return self.model.energy

    @cached_property
    def _compiled(self) -> tuple[NamedTuple, int]:
        forces = self.forces.compiled()
        kernel = LearnedLoadKernel(self.model.kernel, forces.kernel, history_kernel(self.history))
        return kernel, len(forces.input_names) + forces.work_size

    @property
    def kernel(self) -> NamedTuple:
        """The model's kernel and that of the forces in one."""
        return self._compiled[0]

    @property
    def work_size(self) -> int:
        """Model and load use the same scratch, one after the other."""
        return int(max(self.model.work_size, self._compiled[1]))

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at time t [s] and states x (2r,)."""
        x = np.ascontiguousarray(x, dtype=np.float64)
        dx = np.empty_like(x)
        evaluate(self.kernel, float(t), x, dx, np.empty(self.work_size))
        return dx
