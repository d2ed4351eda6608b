"""Rollouts: a surrogate that starts where a recorded trajectory starts, held against that trajectory.

There is no reference model: errors count noise and all. Percents are of the standard deviation of each state
over the training samples.
"""

import math
import statistics
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from flexsurr.config.study import Integrator
from flexsurr.evaluation.candidates import surrogate_candidates
from flexsurr.evaluation.cost import setups
from flexsurr.evaluation.operations import operations
from flexsurr.evaluation.timing import measuring, wall_time
from flexsurr.simulation import Trajectory, simulate, simulate_ensemble
from flexsurr.simulation.rhs import Array, Model
from flexsurr.storage import Manifest, read_shards
from flexsurr.surrogates import Hamiltonian, compiled
from flexsurr.surrogates.forces import RecordedForces

CURVE_POINTS = 400
"""At least so many points draw a smooth curve, however few samples were recorded."""

DATA = "data"
"""What curves call the recorded samples, beside the names of models."""


@dataclass(frozen=True, eq=False)
class HeldOut:
    """A recorded trajectory that no training has seen: its number, t (m,) [s], x (m, d).

    `u` (m, d/2) are the forces that acted on its momenta, if any were recorded.
    """

    number: int
    t: Array
    x: Array
    u: Array | None = None

    def acting_on(self, model: Model) -> Model:
        """`model` under the same forces, if there were any."""
        return model if self.u is None else RecordedForces(model, self.t, self.u)

    def followed_by(self, model: Model, t: Array, integrator: Integrator) -> Trajectory:
        """What `model` does from the first sample on, under the same forces, at times `t` (k,) [s]."""
        return simulate(self.acting_on(model), t, self.x[0], integrator)


@dataclass(frozen=True, eq=False)
class HeldOutTrajectories:
    """Some of a dataset's held-out trajectories, and the spread (d,) of each state over its training samples.

    Where single samples are held out, every trajectory counts: none was seen whole.
    """

    trajectories: tuple[HeldOut, ...]
    spread: Array
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]

    @classmethod
    def of(cls, manifest: Manifest, most: int) -> "HeldOutTrajectories":
        """The first `most`. Raises StorageError naming a shard that is missing, damaged or foreign."""
        wanted = set(manifest.validation[:most])
        found = []
        for shard in read_shards(manifest):
            for number in sorted(wanted.intersection(shard.trajectory.tolist())):
                rows = shard.trajectory == number
                forces = None if shard.u is None else shard.u[rows]
                found.append(HeldOut(number, shard.t[rows], shard.x[rows], forces))
        names = manifest.state_names
        spread = np.array(manifest.scales.standard_deviation[: len(names)])
        return cls(tuple(found), spread, names, manifest.state_units)

    def followed_by(self, model: Model, integrator: Integrator) -> list[Array]:
        """What `model` does from the first sample of each on: states (k, d) at the k samples that it reaches.

        Those with the same times are one ensemble.
        """
        found: dict[int, Array] = {}
        by_times: dict[bytes, list[HeldOut]] = {}
        for recorded in self.trajectories:
            by_times.setdefault(recorded.t.tobytes(), []).append(recorded)
        for alike in by_times.values():
            models = [recorded.acting_on(model) for recorded in alike]
            starts = np.array([recorded.x[0] for recorded in alike])
            rollouts = simulate_ensemble(models, alike[0].t, starts, integrator, threads=1)
            for recorded, x in zip(alike, rollouts.kept, strict=True):
                found[recorded.number] = x[: int(np.isfinite(x).all(axis=1).sum())]
        return [found[recorded.number] for recorded in self.trajectories]

    def error_percent(self, recorded: HeldOut, x: Array) -> float:
        """Root of the mean square of (x − recorded) over the spread, over samples and states, in percent.

        `x` (k, d) holds the first k samples; infinite unless it holds them all.
        """
        if len(x) < len(recorded.x):
            return math.inf
        return float(100.0 * np.sqrt(np.mean(((x - recorded.x) / self.spread) ** 2)))

    def own_energy_drift_percent(self, recorded: HeldOut, surrogate: Any, x: Array) -> float:
        """Largest |H(t) − H(0)| along `x` (k, d) over the range of H at all recorded samples, in percent.

        H is the surrogate's own: a dissipative form loses it. NaN where it has none, and under forces.
        """
        if recorded.u is not None or not isinstance(surrogate, Hamiltonian):
            return math.nan
        energy = surrogate.energy(x)
        range_of = np.ptp(surrogate.energy(np.concatenate([each.x for each in self.trajectories])))
        return float(100.0 * np.abs(energy - energy[0]).max() / range_of)


def rollout_table(
    surrogates: Mapping[str, Any], held_out: HeldOutTrajectories, integrator: Integrator
) -> pd.DataFrame:
    """One row for each surrogate and trajectory.

    Columns: model, trajectory, samples, duration_s, completed, error_percent and own_energy_drift_percent.
    """
    rows = []
    for name, surrogate in surrogates.items():
        rollouts = held_out.followed_by(compiled(surrogate), integrator)
        for recorded, x in zip(held_out.trajectories, rollouts, strict=True):
            rows.append(
                {
                    "model": name,
                    "trajectory": recorded.number,
                    "samples": len(recorded.t),
                    "duration_s": recorded.t[-1] - recorded.t[0],
                    "completed": len(x) == len(recorded.t),
                    "error_percent": held_out.error_percent(recorded, x),
                    "own_energy_drift_percent": held_out.own_energy_drift_percent(recorded, surrogate, x),
                }
            )
    return pd.DataFrame(rows)


def rollout_errors(
    surrogate: Any, held_out: HeldOutTrajectories, integrator: Integrator
) -> dict[str, float | int | None]:
    """What a run is chosen by: keys as `scores.long_response_errors` has them.

    own_energy_drift_percent, the largest, stands in place of energy_drift_percent. A figure that has no
    finite value is None; a rollout that diverged counts as the worst.
    """
    first = held_out.trajectories[0].x[0]
    table = rollout_table({"": surrogate}, held_out, integrator)
    errors = table["error_percent"].tolist()
    return {
        "long_response_error_percent_worst": _finite(max(errors)),
        "long_response_error_percent_median": _finite(statistics.median(errors)),
        "own_energy_drift_percent": _finite(table["own_energy_drift_percent"].max()),
        "diverged": int((~table["completed"]).sum()),
        "operations": operations(compiled(surrogate), first),
    }


def rollout_curves(
    surrogates: Mapping[str, Any], held_out: HeldOutTrajectories, integrator: Integrator, drawn: int
) -> pd.DataFrame:
    """States against time of the first `drawn` trajectories: the samples (model "data") and each surrogate.

    Columns: trajectory, model, state, unit, t_s, value. A rollout that ends early ends its rows.
    """
    frames = []
    for recorded in held_out.trajectories[:drawn]:
        fine = np.linspace(recorded.t[0], recorded.t[-1], max(CURVE_POINTS, len(recorded.t)))
        curves = {DATA: (recorded.t, recorded.x)}
        for name, surrogate in surrogates.items():
            trajectory = recorded.followed_by(compiled(surrogate), fine, integrator)
            curves[name] = trajectory.t, trajectory.x
        for model, (t, x) in curves.items():
            for state, unit, values in zip(held_out.state_names, held_out.state_units, x.T, strict=True):
                columns = {"trajectory": recorded.number, "model": model, "state": state, "unit": unit}
                frames.append(pd.DataFrame({**columns, "t_s": t, "value": values}))
    return pd.concat(frames, ignore_index=True)


def rollout_cost(
    surrogates: Mapping[str, Any], held_out: HeldOutTrajectories, integrator: Integrator, repeats: int
) -> pd.DataFrame:
    """One row for each surrogate, implementation and integrator; run it alone on the machine.

    Columns: model, implementation, integrator, simulations, duration_s, right_hand_sides (means over the
    rollouts), wall_s_mean, wall_s_std, us_per_right_hand_side (integrator included), error_percent (worst)
    and diverged. Rollouts that diverged are in no mean; figures are NaN where none is left.
    """
    rows = []
    with measuring():
        for setup in setups(surrogate_candidates(surrogates, with_torch=True), [integrator]):
            model, timed = setup.candidate.field, []
            in_python = setup.candidate.implementation != "compiled"
            for recorded in held_out.trajectories:
                # the first steps load or compile what the timed ones use
                recorded.followed_by(model, recorded.t[:2], setup.integrator)
                run = partial(recorded.followed_by, model, recorded.t, setup.integrator)
                trajectory, wall_s = wall_time(run, 1 if in_python else repeats)
                if trajectory.completed:
                    error = held_out.error_percent(recorded, trajectory.x)
                    timed.append((trajectory.t[-1] - trajectory.t[0], trajectory.evaluations, wall_s, error))
            rows.append(
                {
                    "model": setup.candidate.model,
                    "implementation": setup.candidate.implementation,
                    "integrator": setup.integrator.label,
                    **_summary(np.array(timed).reshape(-1, 4)),
                    "simulations": len(held_out.trajectories),
                    "diverged": len(held_out.trajectories) - len(timed),
                }
            )
    return pd.DataFrame(rows)


def _summary(timed: Array) -> dict[str, float]:
    """Of rows (duration, right-hand sides, wall time, error) of rollouts that reached their end."""
    if not len(timed):
        timed = np.full((1, 4), math.nan)
    duration_s, evaluations, wall_s, error = timed.T
    return {
        "duration_s": float(duration_s.mean()),
        "right_hand_sides": float(evaluations.mean()),
        "wall_s_mean": float(wall_s.mean()),
        "wall_s_std": float(wall_s.std(ddof=1)) if len(wall_s) > 1 else math.nan,
        "us_per_right_hand_side": float(1e6 * wall_s.sum() / evaluations.sum()),
        "error_percent": float(error.max()),
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
