"""The compiled integrators by their names in the configuration."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from flexsurr.config.study import Integrator, IntegratorMethod
from flexsurr.simulation.dimension import Dimension, dimension
from flexsurr.simulation.explicit import RungeKutta4, RungeKutta8
from flexsurr.simulation.fixed_step import run_fixed_step
from flexsurr.simulation.outcome import Outcome, from_compiled
from flexsurr.simulation.rhs import Array, Model

_FIXED_STEP: dict[IntegratorMethod, Callable[[Dimension], NamedTuple]] = {
    "rk4": RungeKutta4,
    "dop853_fixed": RungeKutta8,
}

COMPILED = frozenset(_FIXED_STEP)


def run_compiled(model: Model, integrator: Integrator) -> Callable[[Array, Array], Outcome]:
    """The method that `integrator` names, as a function of times t (m,) and states x (m, d) to fill.

    Raises TypeError if the model has no kernel.
    """
    kernel = getattr(model, "kernel", None)
    if kernel is None:
        raise TypeError(f"{integrator.method} steps compiled models; {type(model).__name__} has no kernel")
    work = np.empty(model.work_size)  # type: ignore[attr-defined]  # what has a kernel is a CompiledModel
    constant = dimension(len(model.state_names))
    method = _FIXED_STEP[integrator.method](constant)
    step = integrator.step_s

    def run(t: Array, x: Array) -> Outcome:
        return from_compiled(*run_fixed_step(method, kernel, t, x, step, work))

    return run
