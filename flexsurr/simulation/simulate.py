"""The one way to simulate a model, by whichever integrator."""

from collections.abc import Callable
from typing import NamedTuple, cast

import numpy as np

from flexsurr.config.study import Integrator, IntegratorMethod
from flexsurr.simulation.adaptive_explicit import run_dop853
from flexsurr.simulation.dimension import Dimension, dimension
from flexsurr.simulation.fixed_step import RungeKutta4, RungeKutta8, run_fixed_step
from flexsurr.simulation.gauss_legendre import GaussLegendre4, GaussLegendre6
from flexsurr.simulation.python_kernel import raise_pending
from flexsurr.simulation.radau import run_radau
from flexsurr.simulation.rhs import Array, CompiledModel, Model
from flexsurr.simulation.scipy_methods import run_scipy
from flexsurr.simulation.trajectory import Outcome, Trajectory, from_compiled

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


Run = Callable[[Array, Array], Outcome]
"""Fills x (m, d) from its first row at times t (m,), over which f is smooth."""

# Pieces of time keep this many floating-point spacings off a breakpoint, so that no rounding of a
# stage's time evaluates f on the breakpoint's other side.
_SPACINGS = 4


def simulate(model: Model, t: Array, x0: Array, integrator: Integrator) -> Trajectory:
    """Integrate ẋ = f(t, x) from `x0` (d,) at t[0] and sample it at the increasing times `t` (m,) [s].

    An integrator with a fixed step divides each interval between samples into equal steps of at most
    `step_s`; one that adapts its step interpolates the samples. Each starts anew at the model's
    breakpoints, whether f there belongs to the time before or after. Without tolerances in `integrator`,
    SciPy's defaults hold (rtol 1e-3, atol 1e-6).

    A simulation that fails ends its trajectory: see `Trajectory.completed` and `Trajectory.reason`.

    Raises ValueError if `t` or `x0` has the wrong shape, is not finite or `t` does not increase, and
    TypeError if a compiled method is asked to step a model without a kernel.
    """
    t = np.ascontiguousarray(t, dtype=np.float64)
    x0 = np.asarray(x0, dtype=np.float64)
    check_times(t)
    _check(model, x0)
    run = (run_compiled if integrator.method in COMPILED else run_scipy)(model, integrator)
    x = np.empty((t.size, x0.size))
    x[0] = x0
    breaks = [b for b in model.breakpoints if t[0] < b <= t[-1]]
    if t.size == 1:
        outcome = Outcome(rows=1, end_time_s=float(t[0]), evaluations=0, steps=0, reason="")
    else:
        outcome = _run_pieces(run, t, x, breaks) if breaks else run(t, x)
        raise_pending()
    return Trajectory(
        t=t[: outcome.rows],
        x=x[: outcome.rows],
        state_names=model.state_names,
        state_units=model.state_units,
        completed=not outcome.reason,
        reason=outcome.reason,
        end_time_s=outcome.end_time_s,
        evaluations=outcome.evaluations,
        steps=outcome.steps,
    )


def check_times(t: Array) -> None:
    """Raise ValueError unless `t` holds one or more finite, increasing times."""
    if t.ndim != 1 or t.size == 0 or not np.isfinite(t).all() or (t[1:] <= t[:-1]).any():
        raise ValueError("t must be a vector of at least one finite, increasing time")


def _check(model: Model, x0: Array) -> None:
    d = len(model.state_names)
    if x0.shape != (d,) or not np.isfinite(x0).all():
        raise ValueError(f"x0 must hold {d} finite values, one for each of {', '.join(model.state_names)}")


def _run_pieces(run: Run, t: Array, x: Array, breaks: list[float]) -> Outcome:
    """As `run`, over times at which f jumps within."""
    margin = _SPACINGS * np.spacing(max(abs(t[0]), abs(t[-1])))
    begin, state = t[0], x[0]
    filled, evaluations, steps = 1, 0, 0
    for jump in [*breaks, np.inf]:
        end = min(jump - margin, t[-1])
        if end <= begin:
            continue
        inside = int(np.searchsorted(t, end))
        nodes = np.concatenate(([begin], t[filled:inside], [end]))
        rows = np.empty((nodes.size, state.size))
        rows[0] = state
        piece = run(nodes, rows)
        evaluations += piece.evaluations
        steps += piece.steps
        reached = min(piece.rows, nodes.size - 1)
        x[filled : filled + reached - 1] = rows[1:reached]
        filled += reached - 1
        if piece.reason:
            return Outcome(filled, piece.end_time_s, evaluations, steps, piece.reason)
        begin, state = jump + margin, rows[-1]
        beyond = int(np.searchsorted(t, begin, side="right"))
        x[filled:beyond] = state
        filled = beyond
    return Outcome(filled, float(t[-1]), evaluations, steps, "")
