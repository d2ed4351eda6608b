"""Datasets from shards and from arrays."""

import numpy as np
import pytest
from oscillator import NAMES, UNITS, field, free_responses
from shard_files import write_dataset

from flexsurr.storage import StorageError, read_manifest
from flexsurr.training import ShardedDataset, load_dataset


@pytest.fixture
def manifest(tmp_path):
    """Three shards of two trajectories of ten samples."""
    x = np.random.default_rng(0).uniform(-0.3, 0.3, (6, 10, 2))
    return write_dataset(tmp_path, [(part, field(part)) for part in x], [2, 2, 2], NAMES, UNITS)


def test_every_sample_lies_on_one_side(manifest):
    dataset = load_dataset(manifest)
    train, validation = set(dataset.trajectory_train), set(dataset.trajectory_validation)
    assert train | validation == set(range(6))
    assert not train & validation
    assert (len(dataset.x_train), len(dataset.x_validation)) == (40, 20)
    np.testing.assert_array_equal(dataset.dx_train, field(dataset.x_train))
    assert (dataset.state_names, dataset.state_units) == (NAMES, UNITS)


def test_the_hash_stands_for_the_content(manifest):
    assert load_dataset(manifest).sha256 == ShardedDataset(read_manifest(manifest)).sha256
    assert free_responses(seed=0).sha256 == free_responses(seed=0).sha256 != free_responses(seed=1).sha256


def test_shard_by_shard_it_is_the_same(manifest):
    streamed, loaded = ShardedDataset(read_manifest(manifest)), load_dataset(manifest)
    for part in ("training_blocks", "validation_blocks"):
        blocks = list(getattr(streamed, part)())
        assert len(blocks) == 3
        ((x, dx),) = getattr(loaded, part)()
        np.testing.assert_array_equal(np.concatenate([block[0] for block in blocks]), x)
        np.testing.assert_array_equal(np.concatenate([block[1] for block in blocks]), dx)
    for name in ("mean", "standard_deviation", "largest"):
        np.testing.assert_allclose(getattr(streamed.scales, name), getattr(loaded.scales, name), rtol=1e-12)
    assert (streamed.state_names, streamed.state_units) == (NAMES, UNITS)


@pytest.mark.parametrize(
    "read",
    [load_dataset, lambda path: list(ShardedDataset(read_manifest(path)).training_blocks())],
    ids=["loaded", "streamed"],
)
def test_a_damaged_shard_is_never_trained_on(manifest, read):
    shard = manifest.parent / "shard-2.parquet"
    content = bytearray(shard.read_bytes())
    content[len(content) // 2] ^= 1
    shard.write_bytes(content)
    with pytest.raises(StorageError, match=r"shard-2\.parquet"):
        read(manifest)
