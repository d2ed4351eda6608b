"""Write the user's own files into one shard of a dataset."""

import logging
from pathlib import Path

import numpy as np

from flexsurr.cli.command import Job, command
from flexsurr.config.files import Columns, Filter
from flexsurr.storage import Shard, ShardMetadata, StorageError, write_shard
from flexsurr.storage.source_files import filtered, read_recordings

log = logging.getLogger(__name__)


def main(job: Job, output: Path) -> None:
    """Write the shard of the trajectories in the job's files, numbered in their order.

    StorageError names each file that has changed since the job was planned, or is not as `read_recordings`
    wants it.
    """
    columns = Columns.model_validate(job["columns"])
    found = read_recordings(Path(), list(job["files"]), columns)
    changed = [file for file, sha256 in job["files"].items() if found.sha256[file] != sha256]
    if changed:
        raise StorageError("\n".join(f"{file}: has changed; start again" for file in changed))
    trajectories = found.trajectories
    if job["filter"] is not None:
        by = Filter.model_validate(job["filter"])
        trajectories = tuple(filtered(recording, by) for recording in trajectories)
    u = [each.u for each in trajectories if each.u is not None]
    dx = np.concatenate([each.dx for each in trajectories if each.dx is not None])
    if u:
        # the surrogate learns what the states do by themselves
        dx[:, dx.shape[1] // 2 :] -= np.concatenate(u)
    shard = Shard(
        trajectory=np.repeat(np.arange(len(trajectories)), [len(each.t) for each in trajectories]),
        t=np.concatenate([each.t for each in trajectories]),
        x=np.concatenate([each.x for each in trajectories]),
        dx=dx,
        u=np.concatenate(u) if u else None,
        metadata=ShardMetadata(
            study=job["study"],
            variant=job["variant"],
            seed=job["seed"],
            configuration=job["configuration"],
            first=0,
            count=len(trajectories),
            state_names=columns.state_names,
            state_units=columns.state_units,
            input_names=columns.input_names,
            input_units=columns.input_units,
        ),
    )
    write_shard(output, shard)
    log.info("%s: %d trajectories, %d samples", output, len(trajectories), len(shard.t))


if __name__ == "__main__":
    command(main, {"output": "the shard"})
