"""Samples to train on and samples to validate on: in memory, or shard by shard."""

import hashlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.storage import Manifest, Scales, Shard, read_manifest, read_shards

PIECE = 4096  # samples that `for_each_piece` gives away at a time

Block = tuple[Array, Array]  # states x (m, 2r) and derivatives dx (m, 2r) in the states' units (per second)


class SampleSource(Protocol):
    """Samples that can be read block by block, any number of times."""

    @property
    def state_names(self) -> tuple[str, ...]:
        """Of the 2r states."""
        ...

    @property
    def state_units(self) -> tuple[str, ...]:
        """Of the 2r states."""
        ...

    @property
    def sha256(self) -> str:
        """Stands for everything training depends on."""
        ...

    @property
    def scales(self) -> Scales:
        """Of the training samples."""
        ...

    def training_blocks(self) -> Iterator[Block]:
        """The samples to train on."""
        ...

    def validation_blocks(self) -> Iterator[Block]:
        """The samples to validate on."""
        ...

    def loaded(self) -> "Dataset":
        """All of it in memory."""
        ...


@dataclass(frozen=True, eq=False)
class Dataset:
    """States x (m, 2r) and derivatives dx (m, 2r) in the units of the states (per second), in memory.

    `trajectory_train` and `trajectory_validation` (m,) say which trajectory each sample is of. Satisfies
    `SampleSource`, as one block.
    """

    x_train: Array
    dx_train: Array
    x_validation: Array
    dx_validation: Array
    trajectory_train: NDArray[np.int64]
    trajectory_validation: NDArray[np.int64]
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]
    sha256: str

    @cached_property
    def scales(self) -> Scales:
        """Of the training samples."""
        return Scales.of(self.x_train, self.dx_train)

    def training_blocks(self) -> Iterator[Block]:
        """The samples to train on."""
        yield self.x_train, self.dx_train

    def validation_blocks(self) -> Iterator[Block]:
        """The samples to validate on."""
        yield self.x_validation, self.dx_validation

    def loaded(self) -> "Dataset":
        """Itself."""
        return self

    def thinned(self, most: int) -> "Dataset":
        """The same with at most so many training samples of each trajectory, evenly spread over its own."""
        rows = [
            np.flatnonzero(self.trajectory_train == number) for number in np.unique(self.trajectory_train)
        ]
        kept = np.sort(np.concatenate([_spread(of_one, most) for of_one in rows]))
        return replace(
            self,
            x_train=self.x_train[kept],
            dx_train=self.dx_train[kept],
            trajectory_train=self.trajectory_train[kept],
        )


@dataclass(frozen=True)
class ShardedDataset:
    """The samples of a manifest's shards, of which one is held at a time. Satisfies `SampleSource`.

    Reading raises StorageError naming the shard that is missing, damaged or foreign.
    """

    manifest: Manifest

    @property
    def state_names(self) -> tuple[str, ...]:
        """Of the 2r states."""
        return self.manifest.state_names

    @property
    def state_units(self) -> tuple[str, ...]:
        """Of the 2r states."""
        return self.manifest.state_units

    @property
    def sha256(self) -> str:
        """That of the manifest's content, which has those of the shards."""
        return self.manifest.sha256

    @property
    def scales(self) -> Scales:
        """Of the training samples."""
        return self.manifest.scales

    def training_blocks(self) -> Iterator[Block]:
        """The samples to train on, a block for each shard."""
        return self._blocks(training=True)

    def validation_blocks(self) -> Iterator[Block]:
        """The samples to validate on, a block for each shard."""
        return self._blocks(training=False)

    def _blocks(self, *, training: bool) -> Iterator[Block]:
        def block(shard: Shard) -> Block:
            rows = self.manifest.training_rows(shard) == training
            return shard.x[rows], shard.dx[rows]

        return map(block, read_shards(self.manifest))  # unlike a loop, holds no shard while it reads the next

    def loaded(self) -> Dataset:
        """All of it in memory."""
        shards = list(read_shards(self.manifest))
        trajectory = np.concatenate([shard.trajectory for shard in shards])
        return _split(
            trajectory,
            np.concatenate([shard.x for shard in shards]),
            np.concatenate([shard.dx for shard in shards]),
            np.concatenate([~self.manifest.training_rows(shard) for shard in shards]),
            self.state_names,
            self.state_units,
            self.sha256,
        )


def for_each_piece(blocks: Iterable[Block], *uses: Callable[[Array, Array], None]) -> None:
    """Give the samples of `blocks` to each of `uses`, at most `PIECE` at a time.

    What is made of a piece is therefore small too, and no block is held while the next is read.
    """
    for x, dx in blocks:
        for first in range(0, len(x), PIECE):
            for use in uses:
                use(x[first : first + PIECE], dx[first : first + PIECE])
        del x, dx  # which would otherwise live until the next block is there


def _spread(rows: NDArray[np.int64], most: int) -> NDArray[np.int64]:
    return rows if len(rows) <= most else rows[np.linspace(0, len(rows) - 1, most).round().astype(np.int64)]


def load_dataset(manifest_path: str | Path) -> Dataset:
    """The dataset of a manifest, its shards checked against their hashes one by one.

    Raises StorageError naming the manifest or shard that is missing, damaged or foreign.
    """
    return ShardedDataset(read_manifest(Path(manifest_path))).loaded()


def split_dataset(
    trajectory: NDArray[np.int64],
    x: Array,
    dx: Array,
    *,
    validation: Sequence[int],
    state_names: tuple[str, ...],
    state_units: tuple[str, ...],
) -> Dataset:
    """Samples of trajectories `trajectory` (m,), split into those of `validation` and the others."""
    held_out = np.isin(trajectory, np.asarray(validation))
    sha256 = hashlib.sha256(repr((state_names, state_units)).encode())
    for part in (trajectory, x, dx, held_out):
        sha256.update(np.ascontiguousarray(part).tobytes())
    return _split(trajectory, x, dx, held_out, state_names, state_units, sha256.hexdigest())


def _split(
    trajectory: NDArray[np.int64],
    x: Array,
    dx: Array,
    held_out: NDArray[np.bool_],
    state_names: tuple[str, ...],
    state_units: tuple[str, ...],
    sha256: str,
) -> Dataset:
    return Dataset(
        x_train=np.ascontiguousarray(x[~held_out]),
        dx_train=np.ascontiguousarray(dx[~held_out]),
        x_validation=np.ascontiguousarray(x[held_out]),
        dx_validation=np.ascontiguousarray(dx[held_out]),
        trajectory_train=trajectory[~held_out],
        trajectory_validation=trajectory[held_out],
        state_names=state_names,
        state_units=state_units,
        sha256=sha256,
    )
