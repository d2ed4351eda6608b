"""The compiled integrators by their names in the configuration."""

from collections.abc import Callable
from typing import NamedTuple, cast

import numpy as np

from flexsurr.config.study import Integrator, IntegratorMethod
from flexsurr.simulation.adaptive_explicit import run_dop853
from flexsurr.simulation.dimension import Dimension, dimension
from flexsurr.simulation.explicit import RungeKutta4, RungeKutta8
from flexsurr.simulation.fixed_step import run_fixed_step
from flexsurr.simulation.gauss_legendre import GaussLegendre4, GaussLegendre6
from flexsurr.simulation.outcome import Outcome, from_compiled
from flexsurr.simulation.radau import run_radau
from flexsurr.simulation.rhs import Array, CompiledModel, Model

_FIXED_STEP: dict[IntegratorMethod, Callable[[Dimension], NamedTuple]] = {
    "rk4": RungeKutta4,
    "dop853_fixed": RungeKutta8,
    "gauss_legendre_4": GaussLegendre4,
    "gauss_legendre_6": GaussLegendre6,
}

COMPILED = frozenset({*_FIXED_STEP, "dop853", "radau_iia_5"})

# SciPy's, so that a comparison without tolerances compares like with like.
_RTOL = 1e-3
_ATOL = 1e-6


def run_compiled(model: Model, integrator: Integrator) -> Callable[[Array, Array], Outcome]:
    """The method that `integrator` names, as a function of times t (m,) and states x (m, d) to fill.

    Raises TypeError if the model has no kernel.
    """
    if not hasattr(model, "kernel"):
        raise TypeError(f"{integrator.method} steps compiled models; {type(model).__name__} has no kernel")
    model = cast(CompiledModel, model)
    kernel = model.kernel
    work = np.empty(model.work_size)
    constant = dimension(len(model.state_names))
    step = integrator.step_s
    rtol = _RTOL if integrator.rtol is None else integrator.rtol
    atol = _ATOL if integrator.atol is None else integrator.atol

    def run(t: Array, x: Array) -> Outcome:
        if integrator.method == "dop853":
            return from_compiled(*run_dop853(constant, kernel, t, x, rtol, atol, work))
        if integrator.method == "radau_iia_5":
            return from_compiled(*run_radau(kernel, t, x, rtol, atol, work))
        method = _FIXED_STEP[integrator.method](constant)
        return from_compiled(*run_fixed_step(method, kernel, t, x, step, work))

    return run
