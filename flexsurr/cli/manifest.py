"""Check the shards of a dataset and write the manifest that vouches for them."""

import logging
from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.storage import build_manifest, write_manifest

log = logging.getLogger(__name__)


def main(job: Job, shards: list[Path], output: Path) -> None:
    """Write the manifest of `shards`; StorageError names every shard that does not belong to the dataset."""
    manifest = build_manifest(shards, **job)
    write_manifest(output, manifest)
    log.info("%s: %d trajectories, %d samples", output, manifest.trajectories, manifest.samples)


if __name__ == "__main__":
    command(main, {"shards": "the shards of the dataset …", "output": "the manifest"})
