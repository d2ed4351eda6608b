"""Any model under recorded generalised forces: inputs u(t) that act on the momenta, ṗ = f_p(x) + u(t)."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from flexsurr.simulation.rhs import Array, Forced, implements_rhs, rhs


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
