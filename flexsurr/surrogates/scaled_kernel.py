"""A compiled field of scaled states, in the units of the states."""

from typing import Any, NamedTuple

import numpy as np

from flexsurr.simulation.rhs import Array, implements_rhs, rhs
from flexsurr.surrogates.scaling import StateScaling


class ScaledKernel(NamedTuple):
    """ẋ_i = rates_i f_i(x / s) for any kernel of f; both (d,)."""

    field: Any
    inverse_states: Array
    rates: Array


def scaled_kernel(
    field: NamedTuple, work_size: int, scaling: StateScaling, count: int
) -> tuple[NamedTuple, int]:
    """The kernel of `count` states whose scaled field is that of the kernel `field`, and its workspace.

    For fields into whose weights the scales cannot be folded: those of gradients, unless the scaling is
    canonical and the gradient turned by Hamilton's equations.
    """
    return ScaledKernel(field, 1.0 / scaling.states(count), np.array(scaling.rates(count))), work_size + count


@implements_rhs(ScaledKernel, inline=False)
def _scaled(kernel, t, x, dx, work):
    d = x.size
    for i in range(d):
        work[i] = x[i] * kernel.inverse_states[i]
    rhs(kernel.field, t, work[:d], dx, work[d:])
    for i in range(d):
        dx[i] *= kernel.rates[i]
