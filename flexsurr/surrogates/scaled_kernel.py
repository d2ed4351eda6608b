"""A compiled field of scaled states, in the units of the states."""

from typing import Any, NamedTuple

import numpy as np

from flexsurr.simulation.rhs import Array, implements_rhs, rhs
from flexsurr.surrogates.scaling import StateScaling, origins


class ScaledKernel(NamedTuple):
    """ẋ_i = rates_i f_i((x − x_from) / s) + dx_from_i for any kernel of f; all (d,)."""

    field: Any
    inverse_states: Array
    rates: Array
    x_from: Array
    dx_from: Array


def scaled_kernel(
    field: NamedTuple, work_size: int, scaling: StateScaling, count: int
) -> tuple[NamedTuple, int]:
    """The kernel of `count` states whose scaled field is that of the kernel `field`, and its workspace.

    For fields into whose weights the scales cannot be folded: those of gradients, unless the scaling is
    canonical and the gradient turned by Hamilton's equations.
    """
    rates = np.array(scaling.rates(count))
    kernel = ScaledKernel(field, 1.0 / scaling.states(count), rates, *origins(scaling, count))
    return kernel, work_size + count


@implements_rhs(ScaledKernel, inline=False)
def _scaled(kernel, t, x, dx, work):
    d = x.size
    for i in range(d):
        work[i] = (x[i] - kernel.x_from[i]) * kernel.inverse_states[i]
    rhs(kernel.field, t, work[:d], dx, work[d:])
    for i in range(d):
        dx[i] = dx[i] * kernel.rates[i] + kernel.dx_from[i]
