"""Datasets from shards and from arrays."""

import numpy as np
import pytest
from oscillator import NAMES, UNITS, field, free_responses

from flexsurr.storage import Shard, ShardMetadata, StorageError, build_manifest, write_manifest, write_shard
from flexsurr.training import load_dataset

OF = {"study": "oscillator", "variant": "hamiltonian", "seed": 1, "configuration": "abc"}


@pytest.fixture
def manifest(tmp_path):
    """Three shards of two trajectories of ten samples."""
    paths = []
    for first in (0, 2, 4):
        x = np.random.default_rng(first).uniform(-0.3, 0.3, (20, 2))
        trajectory = np.repeat([first, first + 1], 10)
        metadata = ShardMetadata(**OF, first=first, count=2, state_names=NAMES, state_units=UNITS)
        paths.append(tmp_path / f"shard-{first}.parquet")
        write_shard(paths[-1], Shard(trajectory, np.tile(np.arange(10) / 10, 2), x, field(x), metadata))
    path = tmp_path / "manifest.json"
    write_manifest(path, build_manifest(paths, **OF, trajectories=6, training_fraction=0.7))
    return path


def test_every_sample_lies_on_one_side(manifest):
    dataset = load_dataset(manifest)
    train, validation = set(dataset.trajectory_train), set(dataset.trajectory_validation)
    assert train | validation == set(range(6))
    assert not train & validation
    assert (len(dataset.x_train), len(dataset.x_validation)) == (40, 20)
    np.testing.assert_array_equal(dataset.dx_train, field(dataset.x_train))
    assert (dataset.state_names, dataset.state_units) == (NAMES, UNITS)


def test_the_hash_stands_for_the_content(manifest):
    assert load_dataset(manifest).sha256 == load_dataset(manifest).sha256
    assert free_responses(seed=0).sha256 == free_responses(seed=0).sha256 != free_responses(seed=1).sha256


def test_a_damaged_shard_is_never_trained_on(manifest):
    shard = manifest.parent / "shard-2.parquet"
    content = bytearray(shard.read_bytes())
    content[len(content) // 2] ^= 1
    shard.write_bytes(content)
    with pytest.raises(StorageError, match=r"shard-2\.parquet"):
        load_dataset(manifest)
