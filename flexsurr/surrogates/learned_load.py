"""Any compiled model under a load whose generalised forces are learned: no kinematics are computed.

A load of fixed shape follows one history, F(t) = s(t) f, and so do its generalised forces, s(t) Q̂(η). Of
several loads at once the forces add up.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from flexsurr.simulation.history import (
    HistoriesKernel,
    History,
    breakpoints,
    histories_kernel,
    history_factor,
)
from flexsurr.simulation.mapping import mapping
from flexsurr.simulation.rhs import Array, evaluate, implements_rhs, rhs
from flexsurr.surrogates.learned_map import LearnedMap


class LearnedLoadKernel(NamedTuple):
    """A model's kernel, that of the forces of k loads, and their histories."""

    model: Any
    forces: Any
    histories: HistoriesKernel


@implements_rhs(LearnedLoadKernel, inline=False)
def _learned_load(kernel, t, x, dx, work):
    rhs(kernel.model, t, x, dx, work)
    r, loads = x.size // 2, kernel.histories.kinds.size
    known = False
    for k in range(loads):
        factor = history_factor(kernel.histories, k, t)
        if factor == 0.0:
            continue
        if not known:
            mapping(kernel.forces, x[:r], work[: loads * r], work[loads * r :])
            known = True
        for i in range(r):
            dx[r + i] += factor * work[k * r + i]


@dataclass(frozen=True, eq=False)
class LearnedLoad:
    """A CompiledModel: `model`, whose states are (η, p), under a load of learned generalised forces.

    `forces` maps η (r,) to Q̂ (k r,) at factors of 1, one load after the other, each with its history. Raises
    ValueError where their numbers don't fit.
    """

    model: Any  # a CompiledModel; what more it has, as an energy, is passed on
    forces: LearnedMap
    histories: tuple[History, ...]

    def __post_init__(self) -> None:
        r = len(self.model.state_names) // 2
        inputs, outputs = len(self.forces.inputs.names), len(self.forces.output_names)
        if (inputs, outputs) != (r, r * len(self.histories)):
            raise ValueError(
                f"a map of {inputs} coordinates to {outputs} forces of {len(self.histories)} load(s)"
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
        own = {time for history in self.histories for time in breakpoints(history)}
        return tuple(sorted({*self.model.breakpoints, *own}))

    @property
    def energy(self) -> Any:
        """The model's own energy, without the work of the load; AttributeError where it has none."""
        return self.model.energy

    @cached_property
    def _compiled(self) -> tuple[NamedTuple, int]:
        forces = self.forces.compiled()
        kernel = LearnedLoadKernel(self.model.kernel, forces.kernel, histories_kernel(self.histories))
        return kernel, len(self.forces.output_names) + forces.work_size

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
