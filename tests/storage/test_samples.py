"""Shards of samples on disk."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexsurr.storage import (
    SampleMetadata,
    Samples,
    StorageError,
    read_all_samples,
    read_samples,
    read_shard,
    write_samples,
)


def shard(first: int, count: int, configuration: str = "abc") -> Samples:
    generator = np.random.default_rng(first)
    metadata = SampleMetadata(
        study="airliner",
        sampling="pseudo_random",
        seed=1,
        configuration=configuration,
        first=first,
        count=count,
        input_names=("mach", "alpha"),
        input_units=("1", "rad"),
        input_low=(0.5, -0.1),
        input_high=(0.8, 0.1),
        output_names=("C_L",),
        output_units=("1",),
    )
    return Samples(generator.uniform(size=(count, 2)), generator.uniform(size=(count, 1)), metadata)


@pytest.fixture
def paths(tmp_path) -> list[Path]:
    shards = [shard(0, 4), shard(4, 3)]
    paths = [tmp_path / f"shard-{number}.parquet" for number in range(2)]
    for path, samples in zip(paths, shards, strict=True):
        write_samples(path, samples)
    return paths


def test_what_is_written_is_read_to_the_bit(paths):
    samples, expected = read_samples(paths[1]), shard(4, 3)
    np.testing.assert_array_equal(samples.u, expected.u)
    np.testing.assert_array_equal(samples.y, expected.y)
    assert samples.metadata == expected.metadata


def test_shards_are_joined_in_any_order(paths):
    samples = read_all_samples(paths[::-1], "abc", 7)
    np.testing.assert_array_equal(samples.u, np.concatenate([shard(0, 4).u, shard(4, 3).u]))
    assert (samples.metadata.first, samples.metadata.count) == (0, 7)


def test_shards_that_are_missing_foreign_or_damaged_are_named(paths, tmp_path):
    with pytest.raises(StorageError, match="4 samples of abc; expected 7"):
        read_all_samples(paths[:1], "abc", 7)
    with pytest.raises(StorageError, match="missing or doubled"):
        read_all_samples([paths[1]], "abc", 7)
    with pytest.raises(
        StorageError, match=r"shard-0\.parquet: belongs to the configuration abc; expected def"
    ):
        read_all_samples(paths, "def", 7)
    paths[0].write_bytes(paths[0].read_bytes()[:-50])
    with pytest.raises(StorageError, match=r"shard-0\.parquet: damaged"):
        read_samples(paths[0])
    with pytest.raises(StorageError, match=r"none\.parquet: cannot be read"):
        read_samples(tmp_path / "none.parquet")


def test_numbers_that_are_not_finite_are_refused(tmp_path):
    samples = shard(0, 4)
    samples.y[2] = np.nan
    with pytest.raises(ValueError, match="outputs that are not finite"):
        write_samples(tmp_path / "shard.parquet", samples)
    wrong = replace(shard(0, 4), metadata=shard(0, 5).metadata)
    with pytest.raises(ValueError, match="shapes"):
        write_samples(tmp_path / "shard.parquet", wrong)


def test_a_shard_of_the_other_kind_is_refused(paths):
    with pytest.raises(StorageError, match=r"shard-0\.parquet: its metadata cannot be understood"):
        read_shard(paths[0])
