"""Datasets on disk: Parquet shards and the manifest that vouches for them."""

from flexsurr.storage.files import DamagedFile, StorageError, read_bytes, read_json, replacing, write_json
from flexsurr.storage.manifest import (
    Manifest,
    ShardEntry,
    SplitBy,
    build_manifest,
    read_manifest,
    read_shards,
    split_trajectories,
    write_manifest,
)
from flexsurr.storage.parquet import (
    SampleMetadata,
    Samples,
    Shard,
    ShardMetadata,
    read_all_samples,
    read_samples,
    read_shard,
    write_samples,
    write_shard,
)
from flexsurr.storage.scales import Scales

__all__ = [
    "DamagedFile",
    "Manifest",
    "SampleMetadata",
    "Samples",
    "Scales",
    "Shard",
    "ShardEntry",
    "ShardMetadata",
    "SplitBy",
    "StorageError",
    "build_manifest",
    "read_all_samples",
    "read_bytes",
    "read_json",
    "read_manifest",
    "read_samples",
    "read_shard",
    "read_shards",
    "replacing",
    "split_trajectories",
    "write_json",
    "write_manifest",
    "write_samples",
    "write_shard",
]
