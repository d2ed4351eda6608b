"""Simulate one shard of a dataset: free responses of the reduced-order model from random states."""

import logging
from pathlib import Path

import numpy as np

from flexsurr.beam import EquilibriumNotFound, draw_initial_conditions, reduce, reduced_order
from flexsurr.cli.command import Job, command
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.simulation import simulate
from flexsurr.storage import Shard, ShardMetadata, write_shard

log = logging.getLogger(__name__)


def main(job: Job, output: Path) -> None:
    """Write the shard with the trajectories `first` to `first + count − 1` of the job's dataset."""
    study, first, count = part_of(Study, job["part"]), job["first"], job["count"]
    dataset = study.dataset
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    model = reduced_order(basis, job["variant"], "compiled")
    states = draw_initial_conditions(basis, dataset.initial_conditions, study.seed, first, count)
    times = dataset.step_s * np.arange(round(dataset.duration_s / dataset.step_s) + 1, dtype=np.float64)
    numbers, t, x, dx, failures = [], [], [], [], []
    for number, x0 in zip(range(first, first + count), states, strict=True):
        trajectory = simulate(model, times, x0, dataset.integrator)
        rates = np.array(
            [model.derivative(*sample) for sample in zip(trajectory.t, trajectory.x, strict=True)]
        )
        kept = int(np.isfinite(rates).all(axis=1).cumprod().sum())
        if kept == 0:
            raise ArithmeticError(f"trajectory {number}: its initial state is too large to have a rate")
        if kept < len(rates) or not trajectory.completed:
            reason = trajectory.reason if kept == len(rates) else "the rates left the finite numbers"
            failures.append(f"trajectory {number}: {reason} at {trajectory.t[kept - 1]:g} s")
            log.warning(failures[-1])
        numbers.append(np.full(kept, number))
        t.append(trajectory.t[:kept])
        x.append(trajectory.x[:kept])
        dx.append(rates[:kept])
    shard = Shard(
        trajectory=np.concatenate(numbers),
        t=np.concatenate(t),
        x=np.concatenate(x),
        dx=np.concatenate(dx),
        metadata=ShardMetadata(
            study=job["study"],
            variant=job["variant"],
            seed=study.seed,
            configuration=job["configuration"],
            first=first,
            count=count,
            state_names=model.state_names,
            state_units=model.state_units,
            failures=tuple(failures),
        ),
    )
    write_shard(output, shard)
    log.info("%s: %d trajectories, %d samples, %d failed", output, count, len(shard.t), len(failures))


if __name__ == "__main__":
    command(main, {"output": "the shard"}, expected=(EquilibriumNotFound, ArithmeticError))
