"""Check the shards of a dataset and write the manifest that vouches for them."""

import logging
from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.storage import build_manifest, write_manifest

log = logging.getLogger(__name__)


def main(job: Job, folder: Path, output: Path) -> None:
    """Write the manifest of the shards in `folder`, as many as the job says.

    StorageError names every shard that does not belong to the dataset.
    """
    expected = dict(job)
    shards = [folder / f"shard-{number:04d}.parquet" for number in range(expected.pop("shards"))]
    manifest = build_manifest(shards, **expected)
    write_manifest(output, manifest)
    log.info("%s: %d trajectories, %d samples", output, manifest.trajectories, manifest.samples)


if __name__ == "__main__":
    command(main, {"folder": "of the shards", "output": "the manifest"})
