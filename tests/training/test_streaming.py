"""Linear fits read shard by shard what they would have in memory, and hold one shard at a time."""

import tempfile
import tracemalloc
import weakref
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oscillator import NAMES, UNITS, field
from shard_files import write_dataset

from flexsurr.config.trial import trial_of
from flexsurr.storage import Scales, StorageError, manifest, read_manifest
from flexsurr.training import ShardedDataset, fit, load_dataset
from flexsurr.training.dataset import Dataset

TRIALS = {
    "polynomial": trial_of(architecture="polynomial", degree=4, optimiser="least_squares"),
    "port_hamiltonian": trial_of(architecture="port_hamiltonian", degree=2, optimiser="least_squares"),
}
TRAJECTORIES = 8
of_both = pytest.mark.parametrize("trial", TRIALS.values(), ids=TRIALS)


def noisy(count, seed):
    """Random states and their rates with an error of 1e-3, so that no fit is exact."""
    generator = np.random.default_rng(seed)
    x = generator.uniform(-1.0, 1.0, (count, 2)) * [0.35, 3.5]
    dx = field(x)
    return x, dx * (1.0 + 1e-3 * generator.normal(size=dx.shape))


def written(folder, sizes, samples):
    """The manifest of shards of `sizes` trajectories, each of a number of samples of its own."""
    responses = [noisy(samples + 7 * k, k) for k in range(sum(sizes))]
    return write_dataset(Path(folder), responses, sizes, NAMES, UNITS)


def sizes_of(cuts):
    """Numbers of trajectories between the cuts."""
    places = [0, *(k + 1 for k, cut in enumerate(cuts) if cut), TRAJECTORIES]
    return np.diff(places).tolist()


@of_both
@given(sizes=st.lists(st.booleans(), min_size=TRAJECTORIES - 1, max_size=TRAJECTORIES - 1).map(sizes_of))
@settings(max_examples=12, deadline=None)
def test_however_the_samples_lie_in_shards_the_fit_is_that_of_all_in_memory(trial, sizes):
    with tempfile.TemporaryDirectory() as folder:
        path = written(folder, sizes, 30)
        expected = fit(trial, load_dataset(path), folder)
        found = fit(trial, ShardedDataset(read_manifest(path)), folder)
    assert found.status == expected.status == "finished"
    np.testing.assert_array_equal(found.surrogate.exponents, expected.surrogate.exponents)
    parameters = expected.surrogate.parameters
    np.testing.assert_allclose(
        found.surrogate.parameters, parameters, atol=1e-10 * np.max(np.abs(parameters))
    )
    for name in ("train_nmse", "validation_nmse", "validation_nmse_per_state"):
        np.testing.assert_allclose(getattr(found, name), getattr(expected, name), rtol=1e-8)


class Watched(ShardedDataset):
    """Keeps an eye on every shard and every block, and counts those alive whenever a shard is read."""

    def begin(self, monkeypatch):
        self.__dict__.update(seen=[], alive=[])
        read_shard = manifest.read_shard

        def counting(*arguments):
            self.alive.append(sum(reference() is not None for reference in self.seen))
            shard = read_shard(*arguments)
            self.seen.extend(map(weakref.ref, (shard, shard.x, shard.dx)))
            return shard

        monkeypatch.setattr(manifest, "read_shard", counting)

    def _blocks(self, *, training):
        def noted(block):
            self.seen.extend(map(weakref.ref, block))
            return block

        return map(noted, super()._blocks(training=training))


@of_both
def test_no_shard_is_held_while_the_next_is_read(trial, tmp_path, monkeypatch):
    monkeypatch.setattr("flexsurr.training.dataset.PIECE", 25)
    source = Watched(read_manifest(written(tmp_path, [2, 2, 2, 2], 30)))
    source.begin(monkeypatch)
    fit(trial, source, tmp_path)
    assert len(source.seen) == 5 * len(source.alive)
    assert (
        source.alive == [0] * 4 * 4
    )  # four shards, read to fit, to choose, and for the errors of both parts


class Made:
    """Blocks made when they are asked for, so many of each kind. Satisfies `SampleSource`."""

    state_names, state_units, sha256 = NAMES, UNITS, ""
    scales = Scales.of(*noisy(4000, 0))

    def __init__(self, count):
        self._count = count

    def training_blocks(self):
        return (noisy(4000, seed) for seed in range(self._count))

    validation_blocks = training_blocks


@of_both
def test_memory_does_not_grow_with_the_samples(trial, tmp_path):
    """Twenty blocks take what two take: one block, its rows and the triangle."""

    def peak(count):
        tracemalloc.start()
        fit(trial, Made(count), tmp_path)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    peak(1)
    assert peak(20) < 1.1 * peak(2)


@of_both
def test_a_damaged_shard_ends_the_fit_with_its_name(trial, tmp_path):
    path = written(tmp_path, [3, 3, 2], 30)
    shard = tmp_path / "shard-1.parquet"
    shard.write_bytes(shard.read_bytes()[:-1])
    with pytest.raises(StorageError, match=r"shard-1\.parquet"):
        fit(trial, ShardedDataset(read_manifest(path)), tmp_path)


def test_what_needs_all_samples_loads_them(tmp_path):
    """A network of the streamed dataset is that of the loaded one, to the last digit."""
    source = ShardedDataset(read_manifest(written(tmp_path, [3, 5], 20)))
    trial = trial_of(
        architecture="hnn", hidden=(4,), activation="tanh", optimiser="levenberg_marquardt", epochs=3
    )
    results = [fit(trial, data, tmp_path / name) for data, name in ((source, "a"), (source.loaded(), "b"))]
    assert isinstance(source.loaded(), Dataset)
    np.testing.assert_array_equal(*(result.surrogate.parameters for result in results))
