"""Datasets of simulated trajectories."""

import logging
from pathlib import Path

import numpy as np

from flexsurr.beam import EquilibriumNotFound, draw_initial_conditions, reduce, reduced_order
from flexsurr.cli.batch import make_all, shards_of
from flexsurr.cli.command import Job, for_rules
from flexsurr.config.schema import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.simulation import simulate_ensemble
from flexsurr.simulation.rhs import rates
from flexsurr.storage import Shard, ShardMetadata, write_shard

log = logging.getLogger(__name__)

REFUSED = (EquilibriumNotFound, ArithmeticError)
"""What a shard that cannot be simulated raises."""


@for_rules(*REFUSED, output="the shard")
def simulate(job: Job, output: Path) -> None:
    """Simulate one shard of a dataset: free responses of the reduced-order model from random states.

    It holds the trajectories `first` to `first + count − 1` of the job's dataset.
    """
    study, first, count = part_of(Study, job["part"]), job["first"], job["count"]
    dataset = study.dataset
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    model = reduced_order(basis, job["variant"], "compiled")
    states = draw_initial_conditions(basis, dataset.initial_conditions, study.seed, first, count)
    times = dataset.step_s * np.arange(round(dataset.duration_s / dataset.step_s) + 1, dtype=np.float64)
    responses = simulate_ensemble(model, times, states, dataset.integrator, threads=1)
    x = responses.kept
    dx = rates(model, np.tile(times, count), x.reshape(-1, x.shape[-1])).reshape(x.shape)
    reached = np.asarray(np.isfinite(x).all(axis=-1))
    # up to the first sample without a state or without rates
    kept = (reached & np.isfinite(dx).all(axis=-1)).cumprod(axis=1).astype(bool)
    failures = []
    for k in np.flatnonzero(~kept.all(axis=1)).tolist():
        samples = int(kept[k].sum())
        if samples == 0:
            raise ArithmeticError(f"trajectory {first + k}: its initial state is too large to have a rate")
        ended = samples == int(reached[k].sum())
        why = responses.reasons[k] if ended else "the rates left the finite numbers"
        failures.append(f"trajectory {first + k}: {why} at {times[samples - 1]:g} s")
        log.warning(failures[-1])
    shard = Shard(
        trajectory=np.repeat(np.arange(first, first + count), kept.sum(axis=1)),
        t=np.tile(times, (count, 1))[kept],
        x=x[kept],
        dx=dx[kept],
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


@for_rules(results="the folder of results", output="what is made")
def shards(job: Job, results: Path, output: Path) -> None:
    """Simulate a batch of shards of a dataset: those that are missing or out of date.

    They lie below `results`; `output` lists them.
    """
    make_all(shards_of(job, results, simulate), results, output, REFUSED)
