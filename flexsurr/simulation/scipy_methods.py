"""SciPy's adaptive solvers, stepped one by one, so that a failure keeps the samples before it."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexsurr.config.study import Integrator
from flexsurr.kernel_cache import NotCompiled
from flexsurr.simulation.rhs import Array, Model
from flexsurr.simulation.trajectory import Outcome

SOLVERS = {
    "scipy_radau": "Radau",
    "scipy_bdf": "BDF",
    "scipy_lsoda": "LSODA",
    "scipy_rk45": "RK45",
    "scipy_dop853": "DOP853",
}
"""The names of SciPy's classes."""

# A solver that is fed NaN may shrink its step for ever.
_LONGEST_RUN_OF_NON_FINITE = 1000


class _Derivative:
    """The model's derivative as SciPy calls it, counted and watched."""

    def __init__(self, model: Model) -> None:
        self._derivative = model.derivative
        self.evaluations = 0
        self._non_finite = 0

    def __call__(self, t: float, x: Array) -> Array:
        self.evaluations += 1
        dx = self._derivative(t, x)
        self._non_finite = 0 if np.isfinite(dx).all() else self._non_finite + 1
        if self._non_finite > _LONGEST_RUN_OF_NON_FINITE or (self._non_finite and self.evaluations == 1):
            raise FloatingPointError(f"the derivative at t = {t:.6g} s is not finite")
        return dx


def run_scipy(model: Model, integrator: Integrator) -> Callable[[Array, Array], Outcome]:
    """The solver that `integrator` names, as a function of times t (m,) and states x (m, d) to fill."""
    from scipy import integrate  # here, for it takes a third of a second that compiled integrators don't need

    tolerances = {
        name: value for name in ("rtol", "atol") if (value := getattr(integrator, name)) is not None
    }
    solver_class = getattr(integrate, SOLVERS[integrator.method])
    says_why = solver_class is integrate.LSODA  # in a warning

    def run(t: Array, x: Array) -> Outcome:
        derivative = _Derivative(model)
        progress = _Progress(float(t[0]))
        with warnings.catch_warnings(record=says_why) as said:
            try:
                solver = solver_class(derivative, t[0], x[0], t[-1], **tolerances)
                reason = _drive(solver, t, x, progress)
            except NotCompiled:
                raise  # it is not the state that ends this
            except Exception as error:  # whatever a model's Python raises is why its simulation ended
                reason = f"{type(error).__name__}: {error}"
        if reason:
            reason = "; ".join([reason, *(str(w.message) for w in said or ())])
            reason = f"{reason} (after t = {progress.time_s:.6g} s)"
        return Outcome(progress.rows, progress.time_s, derivative.evaluations, progress.steps, reason)

    return run


@dataclass
class _Progress:
    time_s: float
    rows: int = 1
    steps: int = 0


def _drive(solver: Any, t: Array, x: Array, progress: _Progress) -> str:
    """Step to the end and fill x; why that ended early, or nothing."""
    while solver.status == "running":
        message = solver.step()
        if solver.status == "failed":
            return message or "the solver failed"
        if solver.t <= progress.time_s:  # LSODA would go on so for ever
            return "the step size fell below the spacing of floating-point numbers"
        reached = int(np.searchsorted(t, solver.t, side="right"))
        new = slice(progress.rows, reached)
        if reached > progress.rows:
            x[new] = solver.dense_output()(t[new]).T
        if not (np.isfinite(solver.y).all() and np.isfinite(x[new]).all()):
            return "the state left the finite numbers"
        progress.time_s = float(solver.t)
        progress.rows = reached
        progress.steps += 1
    return ""
