"""Any compiled model under a load whose generalised forces are learned: no kinematics are computed.

A load of fixed shape follows one history, F(t) = s(t) f, and so do its generalised forces, s(t) Q̂(η). Of
several loads at once the forces add up.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from flexsurr.simulation.history import (
    HistoriesKernel,
    History,
    breakpoints,
    histories_kernel,
    history_factor,
)
from flexsurr.simulation.mapping import mapping
from flexsurr.simulation.rhs import ByKernel, Forced, implements_rhs, rhs
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
class LearnedLoad(ByKernel, Forced):
    """A CompiledModel: the compiled `model` of states (η, p) under a load of learned generalised forces.

    `forces` maps η (r,) to Q̂ (k r,) at factors of 1, one load after the other, each with its history. Raises
    ValueError where their numbers don't fit.
    """

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
    def jumps(self) -> tuple[float, ...]:
        """Times [s] at which the load may jump."""
        return tuple(time for history in self.histories for time in breakpoints(history))

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
