"""Any model under generalised forces that need no kinematics: learned ones of a load, or recorded ones.

A load of fixed shape follows one history, F(t) = s(t) f, and so do its generalised forces, s(t) Q̂(η). Of
several loads at once the forces add up. Recorded forces u(t) act on the momenta, ṗ = f_p(x) + u(t).
"""

from collections.abc import Iterable
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
from flexsurr.simulation.rhs import Array, ByKernel, Forced, implements_rhs, rhs
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
    def jumps(self) -> Iterable[float]:
        """Times [s] at which the load may jump."""
        return (time for history in self.histories for time in breakpoints(history))

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


class RecordedForcesKernel(NamedTuple):
    """A model's kernel, times t (m,) and forces u (m, r) at them; straight lines between."""

    model: Any
    t: Array
    u: Array


@implements_rhs(RecordedForcesKernel, inline=False)
def _recorded_forces(kernel, t, x, dx, work):
    rhs(kernel.model, t, x, dx, work)
    times = kernel.t
    below, above = 0, times.size - 1
    while above - below > 1:
        middle = (below + above) // 2
        if times[middle] <= t:
            below = middle
        else:
            above = middle
    share = (t - times[below]) / (times[above] - times[below])
    share = min(max(share, 0.0), 1.0)
    r = x.size // 2
    for k in range(r):
        dx[r + k] += (1.0 - share) * kernel.u[below, k] + share * kernel.u[above, k]


@dataclass(frozen=True, eq=False)
class RecordedForces(Forced):
    """A model whose states are (q, p), under forces `u` (m, r) recorded at times `t` (m,) [s].

    Between samples forces are straight lines, beyond the first and the last as they are there. It is a
    CompiledModel if `model` is one. Raises ValueError where the forces do not fit the states.
    """

    t: Array
    u: Array

    def __post_init__(self) -> None:
        shape = (len(self.t), len(self.model.state_names) // 2)
        if self.u.shape != shape or len(self.t) < 2:
            raise ValueError(
                f"forces of shape {self.u.shape} do not fit; allowed: {shape}, two samples or more"
            )

    @cached_property
    def kernel(self) -> NamedTuple:
        """The model's kernel with the forces."""
        t, u = (np.ascontiguousarray(each, dtype=np.float64) for each in (self.t, self.u))
        return RecordedForcesKernel(self.model.kernel, t, u)

    @property
    def work_size(self) -> int:
        """That of the model."""
        size: int = self.model.work_size
        return size

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at time t [s] and states x (2r,)."""
        dx = np.array(self.model.derivative(t, x), dtype=np.float64)
        dx[dx.size // 2 :] += [np.interp(t, self.t, force) for force in self.u.T]
        return dx
