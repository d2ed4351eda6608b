"""Many trajectories in one call, on all cores."""

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexsurr.config.study import Integrator
from flexsurr.simulation.dimension import LANES
from flexsurr.simulation.python_kernel import calls_python
from flexsurr.simulation.rhs import Array, Model
from flexsurr.simulation.side_by_side import run_block, takes
from flexsurr.simulation.simulate import COMPILED, check_times, simulate
from flexsurr.simulation.trajectory import Outcome

Observe = Callable[[slice, Array], Array]
"""What is kept of some trajectories, (k, ...), of which numbers and states x (k, m, d) are given."""


@dataclass(frozen=True, slots=True)
class Ensemble:
    """What is kept of n trajectories, and how each ended."""

    t: Array
    """Times [s], (m,)."""
    kept: Array
    """States (n, m, d), or what was observed of them, (n, ...). Not a number where a trajectory had ended."""
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]
    completed: NDArray[np.bool_]
    """Which trajectories reached their end, (n,)."""
    reasons: tuple[str, ...]
    """Why each ended early; empty where it did not."""
    end_time_s: Array
    """Time of the last accepted state of each [s], (n,)."""
    evaluations: int
    """Evaluations of the right-hand side, of all trajectories."""


def simulate_ensemble(
    model: Model | Sequence[Model],
    t: Array,
    x0: Array,
    integrator: Integrator,
    *,
    observe: Observe | None = None,
    threads: int | None = None,
) -> Ensemble:
    """Integrate from each of the states `x0` (n, d) at t[0] and sample at the increasing times `t` (m,) [s].

    model: one for all, or one for each, such as one under different loads.
    observe: keeps (k, ...) of the trajectories `numbers` (a slice) with states (k, m, d), block by block, so
    that memory is bounded by the block, and not by all states. None: all states. Threads call it.
    threads: None, as many as there are cores. Models that call Python have one.

    With a fixed explicit step (rk4, dop853_fixed) blocks of 64 trajectories of a small model that has a form
    for it are stepped side by side; results are then those of `simulate` to rounding, else to the bit. They
    are the same to the bit whatever the number of threads, and whatever the other trajectories do. A
    trajectory that fails ends by itself.

    Raises as `simulate`, ValueError naming the first state that is not finite, and ValueError for a number of
    models or of threads that does not fit.
    """
    t = np.ascontiguousarray(t, dtype=np.float64)
    x0 = np.ascontiguousarray(x0, dtype=np.float64)
    models = list(model) if isinstance(model, Sequence) else [model] * len(x0)
    _check(models, t, x0, threads)
    outcomes: list[Outcome | None] = [None] * len(x0)

    def run(numbers: slice) -> Array:
        x, ended = _run(models[numbers], t, x0[numbers], integrator, len(x0) >= LANES)
        outcomes[numbers] = ended
        # a copy, for what is observed may be a part that keeps the whole block in memory
        return x if observe is None else np.array(observe(numbers, x))

    blocks = [slice(k, min(k + LANES, len(x0))) for k in range(0, len(x0), LANES)]
    first = run(blocks[0])
    kept = np.empty((len(x0), *first.shape[1:]), dtype=first.dtype)
    kept[blocks[0]] = first
    for numbers, part in _in_threads(run, blocks[1:], _threads(models, integrator, threads)):
        kept[numbers] = part
    ended = [outcome for outcome in outcomes if outcome is not None]
    return Ensemble(
        t=t,
        kept=kept,
        state_names=models[0].state_names,
        state_units=models[0].state_units,
        completed=np.array([not each.reason for each in ended]),
        reasons=tuple(each.reason for each in ended),
        end_time_s=np.array([each.end_time_s for each in ended]),
        evaluations=sum(each.evaluations for each in ended),
    )


def _check(models: list[Model], t: Array, x0: Array, threads: int | None) -> None:
    check_times(t)
    if x0.ndim != 2 or len(x0) == 0:
        raise ValueError(f"x0 must hold one or more states, (n, d), not an array of shape {x0.shape}")
    if len(models) != len(x0):
        raise ValueError(f"{len(models)} models do not fit {len(x0)} states; allowed: one, or one for each")
    names = models[0].state_names
    if x0.shape[1] != len(names):
        raise ValueError(f"x0 must hold {len(names)} values a state, one for each of {', '.join(names)}")
    lost = ~np.isfinite(x0).all(axis=1)
    if lost.any():
        raise ValueError(f"x0 must be finite; state number {int(np.argmax(lost))} is not")
    if threads is not None and threads < 1:
        raise ValueError(f"threads: {threads} is not allowed; allowed: 1 or more")


def _run(
    models: list[Model], t: Array, x0: Array, integrator: Integrator, in_blocks: bool
) -> tuple[Array, list[Outcome]]:
    """States (k, m, d) from `x0` (k, d), and how each trajectory ended."""
    alike = all(model is models[0] for model in models)
    if in_blocks and alike and takes(models[0], integrator):
        return run_block(models[0], integrator, t, x0)
    x = np.full((len(x0), t.size, x0.shape[1]), np.nan)
    outcomes = []
    for states, model, start in zip(x, models, x0, strict=True):
        found = simulate(model, t, start, integrator)
        states[: len(found.t)] = found.x
        outcomes.append(Outcome(len(found.t), found.end_time_s, found.evaluations, found.steps, found.reason))
    return x, outcomes


def _threads(models: list[Model], integrator: Integrator, threads: int | None) -> int:
    """As many as asked for, or as there are cores; one where Python would be called."""
    kernels = {id(model): getattr(model, "kernel", ()) for model in models}
    if integrator.method not in COMPILED or any(map(calls_python, kernels.values())):
        return 1
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return threads


def _in_threads(
    run: Callable[[slice], Array], blocks: list[slice], threads: int
) -> Iterator[tuple[slice, Array]]:
    """Each block and what `run` makes of it, in their order; only so many are begun as threads can take."""
    if threads == 1:
        yield from ((block, run(block)) for block in blocks)
        return
    pool = ThreadPoolExecutor(threads)
    try:
        yield from zip(blocks, pool.map(run, blocks), strict=True)
    finally:
        pool.shutdown(cancel_futures=True)
