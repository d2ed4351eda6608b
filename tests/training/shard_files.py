"""Datasets as shards on disk."""

from pathlib import Path

import numpy as np

from flexsurr.storage import Shard, ShardMetadata, build_manifest, write_manifest, write_shard

OF = {"study": "oscillator", "variant": "hamiltonian", "seed": 1, "configuration": "abc"}


def write_dataset(
    folder: Path, responses, sizes, names, units, training_fraction=0.7, split_by="trajectory"
) -> Path:
    """The manifest of shards of `sizes` trajectories each; `responses`: (x, dx) of every trajectory."""
    paths: list[Path] = []
    for first, count in zip(np.cumsum([0, *sizes[:-1]]).tolist(), sizes, strict=True):
        chosen = responses[first : first + count]
        shard = Shard(
            np.repeat(np.arange(first, first + count), [len(x) for x, _ in chosen]),
            np.concatenate([np.arange(len(x)) / 100 for x, _ in chosen]),
            np.concatenate([x for x, _ in chosen]),
            np.concatenate([dx for _, dx in chosen]),
            ShardMetadata(**OF, first=first, count=count, state_names=names, state_units=units),
        )
        paths.append(folder / f"shard-{len(paths)}.parquet")
        write_shard(paths[-1], shard)
    manifest = build_manifest(
        paths,
        **OF,
        trajectories=len(responses),
        split_by=split_by,
        training_fraction=training_fraction,
    )
    write_manifest(folder / "manifest.json", manifest)
    return folder / "manifest.json"
