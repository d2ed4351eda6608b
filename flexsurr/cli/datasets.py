"""Datasets as files: read from the user's own, and the manifest that vouches for the shards of one."""

import logging
from pathlib import Path

import numpy as np

from flexsurr.cli.command import Job, for_rules
from flexsurr.config.files import Columns, Filter
from flexsurr.storage import Shard, ShardMetadata, StorageError, build_manifest, write_manifest, write_shard

log = logging.getLogger(__name__)


@for_rules(output="the shard")
def ingest(job: Job, output: Path) -> None:
    """Write the user's own files into one shard of a dataset.

    Trajectories are numbered in the order of the job's files. StorageError names each file that has changed
    since the job was planned, or is not as `read_recordings` wants it.
    """
    from flexsurr.storage.source_files import filtered, read_recordings  # here, for they read by pandas

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


@for_rules(folder="of the shards", output="the manifest")
def manifest(job: Job, folder: Path, output: Path) -> None:
    """Check the shards of a dataset and write the manifest that vouches for them.

    `folder` has as many as the job says. StorageError names every shard that does not belong to the dataset.
    """
    expected = dict(job)
    shards = [folder / f"shard-{number:04d}.parquet" for number in range(expected.pop("shards"))]
    manifest = build_manifest(shards, **expected)
    write_manifest(output, manifest)
    log.info("%s: %d trajectories, %d samples", output, manifest.trajectories, manifest.samples)
