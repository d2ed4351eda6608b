import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexsurr.storage import (
    StorageError,
    build_manifest,
    manifest,
    read_manifest,
    read_shard,
    read_shards,
    split_trajectories,
    write_manifest,
    write_shard,
)

DATASET = {"study": "beam", "variant": "hamiltonian", "seed": 7, "configuration": "c0ffee"}


def build(paths: list[Path], trajectories: int = 6, split_by="trajectory"):
    return build_manifest(
        paths, **DATASET, trajectories=trajectories, split_by=split_by, training_fraction=0.8
    )


@given(count=st.integers(2, 300), fraction=st.floats(0.01, 0.99), seed=st.integers(0, 2**32))
def test_the_split_is_a_partition_and_repeats_itself(count, fraction, seed):
    train, validation = split_trajectories(count, fraction, seed)
    assert train
    assert validation
    assert sorted(train + validation) == list(range(count))
    assert abs(len(train) - fraction * count) <= 1
    assert split_trajectories(count, fraction, seed) == (train, validation)


def test_another_seed_splits_otherwise():
    assert split_trajectories(50, 0.8, 1) != split_trajectories(50, 0.8, 2)


def test_a_split_by_sample_takes_its_share_of_every_shard(dataset):
    """Whatever the other shards are; and the scales are those of the samples that train."""
    manifest = build(dataset, split_by="sample")
    shards = [read_shard(path) for path in dataset]
    rows = [manifest.training_rows(shard) for shard in shards]
    assert [row.sum() for row in rows] == [round(0.8 * len(row)) for row in rows]
    assert any(
        0 < row[shard.trajectory == shard.trajectory[0]].mean() < 1
        for row, shard in zip(rows, shards, strict=True)
    )
    values = np.concatenate([np.hstack([s.x, s.dx])[row] for s, row in zip(shards, rows, strict=True)])
    np.testing.assert_allclose(manifest.scales.mean, values.mean(axis=0), rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(manifest.scales.low, values.min(axis=0))
    np.testing.assert_array_equal(manifest.scales.high, values.max(axis=0))
    assert manifest.sha256 != build(dataset).sha256
    assert manifest.sha256 != replace(manifest, seed=8).sha256


def test_a_manifest_is_read_as_it_was_written(dataset):
    manifest = build(dataset)
    path = dataset[0].parent / "manifest.json"
    write_manifest(path, manifest)
    assert read_manifest(path) == manifest
    assert (manifest.trajectories, manifest.samples) == (6, 24)


def test_the_order_of_the_shards_does_not_matter(dataset):
    assert build(dataset[::-1]) == build(dataset)


def test_the_hash_is_of_what_training_depends_on(dataset, make_shard):
    manifest = build(dataset)
    assert replace(manifest, study="wing", configuration="decaf").sha256 == manifest.sha256
    others = [
        replace(manifest, train=manifest.validation, validation=manifest.train),
        replace(manifest, state_names=("eta_1", "q_1")),
        replace(manifest, state_units=("1", "kg m2/s")),
    ]
    shard = make_shard(2, 2)
    write_shard(dataset[1], replace(shard, x=shard.x + 1e-9))
    others.append(build(dataset))
    assert len({manifest.sha256, *(other.sha256 for other in others)}) == 5


def test_scales_are_those_of_the_training_trajectories_alone(dataset):
    manifest = build(dataset)
    shards = [read_shard(path) for path in dataset]
    rows = np.isin(np.concatenate([s.trajectory for s in shards]), manifest.train)
    values = np.concatenate([np.hstack([s.x, s.dx]) for s in shards])[rows]
    np.testing.assert_allclose(manifest.scales.mean, values.mean(axis=0), rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(manifest.scales.standard_deviation, values.std(axis=0), rtol=1e-12)
    np.testing.assert_allclose(manifest.scales.largest, np.abs(values).max(axis=0), rtol=0)


@pytest.mark.parametrize(
    ("key", "value"),
    [("study", "wing"), ("variant", "as_printed"), ("seed", 8), ("configuration", "decaf")],
)
def test_a_foreign_shard_is_named(dataset, make_shard, key, value):
    write_shard(dataset[1], make_shard(2, 2, **{key: value}))
    with pytest.raises(
        StorageError, match=rf"shard-0001\.parquet: belongs to another dataset: {key} {value!r}"
    ):
        build(dataset)


def test_every_bad_shard_is_named_at_once(dataset, make_shard):
    dataset[0].write_bytes(b"PAR1 nothing PAR1")
    write_shard(dataset[2], make_shard(4, 2, seed=8))
    with pytest.raises(
        StorageError, match=r"shard-0000\.parquet: damaged(.|\n)*shard-0002\.parquet: belongs"
    ):
        build(dataset)


def test_shards_of_mixed_states_are_named(dataset, make_shard):
    write_shard(dataset[1], make_shard(2, 2, state_names=("eta_1", "q_1")))
    with pytest.raises(StorageError, match=r"shard-0001\.parquet: has other states"):
        build(dataset)


@pytest.mark.parametrize(
    ("first", "message"),
    [(1, r"trajectory 1 is also in shard-0000\.parquet"), (5, "trajectory 6 lies beyond the 6 expected")],
)
def test_shards_that_overlap_or_go_too_far_are_named(dataset, make_shard, first, message):
    write_shard(dataset[1], make_shard(first, 2))
    with pytest.raises(StorageError, match=message):
        build(dataset)


def test_missing_trajectories_are_named(dataset):
    with pytest.raises(StorageError, match=r"no shard holds the trajectories \[2, 3\]"):
        build([dataset[0], dataset[2]])


def test_a_shard_changed_after_the_manifest_is_never_read(dataset, make_shard):
    manifest = build(dataset)
    shard = make_shard(2, 2)
    write_shard(dataset[1], replace(shard, x=shard.x + 1e-9))
    stream = read_shards(manifest)
    assert next(stream).metadata.first == 0
    with pytest.raises(StorageError, match=r"shard-0001\.parquet: is not the file that was recorded"):
        next(stream)


def test_a_recorded_shard_of_another_dataset_is_never_read(dataset):
    manifest = replace(build(dataset), configuration="decaf")
    with pytest.raises(StorageError, match=r"shard-0000\.parquet: belongs to another dataset: configuration"):
        next(read_shards(manifest))


@pytest.mark.parametrize("content", ["", "{", "[]", "{}", '{"format_version": 1}', '{"format_version": 2}'])
def test_a_damaged_manifest_is_named(tmp_path, content):
    path = tmp_path / "manifest.json"
    path.write_text(content)
    with pytest.raises(StorageError, match=r"manifest\.json"):
        read_manifest(path)


def test_only_the_last_shard_is_held_while_the_next_is_read(tmp_path, make_shard, monkeypatch):
    paths = [tmp_path / f"shard-{number:04d}.parquet" for number in range(5)]
    for number, path in enumerate(paths):
        write_shard(path, make_shard(number, 1))
    seen, alive = [], []
    read_shard = manifest.read_shard

    def counting(path):
        alive.append(sum(reference() is not None for reference in seen))
        shard = read_shard(path)
        seen.extend(map(weakref.ref, (shard.x, shard.dx)))
        return shard

    monkeypatch.setattr(manifest, "read_shard", counting)
    build(paths, trajectories=5)
    assert len(alive) == 5
    assert max(alive) <= 2  # x and dx of the last
