"""Any model under generalised forces that need no kinematics: learned ones of a load, or recorded ones.

A load of fixed shape follows one history, F(t) = s(t) f, and so do its generalised forces, s(t) Q̂(η). Of
several loads at once the forces add up. Recorded forces u(t) act on the momenta, ṗ = f_p(x) + u(t).
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from flexsurr.simulation.history import (
    HistoriesKernel,
    History,
    breakpoints,
    histories_kernel,
    history_factor,
)
from flexsurr.simulation.jacobian import implements_jacobian, jacobian
from flexsurr.simulation.mapping import mapping, mapping_jacobian
from flexsurr.simulation.rhs import FLOATING_POINT, Array, ByKernel, Forced, implements_rhs, rhs
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


@implements_jacobian(LearnedLoadKernel)
def _jacobian_under_learned_load(kernel, t, x, dx, jac, work):
    d, loads = x.size, kernel.histories.kinds.size
    r = d // 2
    rates, forces = work[:d], work[d : d + loads * r]
    scratch = work[d + loads * r :]
    for i in range(d):
        rates[i] = dx[i]
    mapping(kernel.forces, x[:r], forces, scratch)
    for k in range(loads):
        factor = history_factor(kernel.histories, k, t)
        for i in range(r):
            rates[r + i] -= factor * forces[k * r + i]
    taken = jacobian(kernel.model, t, x, rates, jac, scratch)
    by_eta = work[: loads * r * r]
    mapping_jacobian(kernel.forces, x[:r], by_eta, work[loads * r * r :])
    for k in range(loads):
        factor = history_factor(kernel.histories, k, t)
        for i in range(r):
            for j in range(r):
                jac[r + i, j] += factor * by_eta[(k * r + i) * r + j]
    return taken


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
        # the model's rates and the forces, or those by η, and what model or map need
        outputs, r = len(self.forces.output_names), len(self.forces.inputs.names)
        return kernel, 2 * r + outputs * (r + 1) + max(self.model.work_size, forces.work_size)

    @property
    def kernel(self) -> NamedTuple:
        """The model's kernel and that of the forces in one."""
        return self._compiled[0]

    @property
    def work_size(self) -> int:
        """Model and load use the same scratch, one after the other."""
        return int(self._compiled[1])


class RecordedForcesKernel(NamedTuple):
    """A model's kernel, times t (m,) and forces u (m, r) at them; straight lines between."""

    model: Any
    t: Array
    u: Array


@njit(error_model="numpy", fastmath=FLOATING_POINT, _nrt=False)
def _sample(times, t):
    """The sample before t [s], and the share of the next one, 0 to 1."""
    below, above = 0, times.size - 1
    while above - below > 1:
        middle = (below + above) // 2
        if times[middle] <= t:
            below = middle
        else:
            above = middle
    share = (t - times[below]) / (times[above] - times[below])
    return below, min(max(share, 0.0), 1.0)


@implements_rhs(RecordedForcesKernel, inline=False)
def _recorded_forces(kernel, t, x, dx, work):
    rhs(kernel.model, t, x, dx, work)
    below, share = _sample(kernel.t, t)
    r = x.size // 2
    for k in range(r):
        dx[r + k] += (1.0 - share) * kernel.u[below, k] + share * kernel.u[below + 1, k]


@implements_jacobian(RecordedForcesKernel)
def _jacobian_under_recorded_forces(kernel, t, x, dx, jac, work):
    d = x.size
    r = d // 2
    below, share = _sample(kernel.t, t)
    for k in range(r):
        work[k] = dx[k]
        work[r + k] = dx[r + k] - (1.0 - share) * kernel.u[below, k] - share * kernel.u[below + 1, k]
    return jacobian(kernel.model, t, x, work[:d], jac, work[d:])


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
        """That of the model, and its rates."""
        size: int = self.model.work_size + len(self.state_names)
        return size

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (2r,) at time t [s] and states x (2r,)."""
        dx = np.array(self.model.derivative(t, x), dtype=np.float64)
        dx[dx.size // 2 :] += [np.interp(t, self.t, force) for force in self.u.T]
        return dx
