"""Samples to train on and samples to validate on, split by trajectory."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.storage import Scales, read_manifest, read_shards


@dataclass(frozen=True, eq=False)
class Dataset:
    """States x (m, 2r) and derivatives dx (m, 2r) in the units of the states (per second).

    `trajectory_train` and `trajectory_validation` (m,) say which trajectory each sample is of. The
    hash stands for everything training depends on.
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


def load_dataset(manifest_path: str | Path) -> Dataset:
    """The dataset of a manifest, its shards checked against their hashes one by one.

    Raises StorageError naming the manifest or shard that is missing, damaged or foreign.
    """
    manifest_path = Path(manifest_path)
    manifest = read_manifest(manifest_path)
    shards = list(read_shards(manifest))
    return split_dataset(
        np.concatenate([shard.trajectory for shard in shards]),
        np.concatenate([shard.x for shard in shards]),
        np.concatenate([shard.dx for shard in shards]),
        validation=manifest.validation,
        state_names=manifest.state_names,
        state_units=manifest.state_units,
    )


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
    return Dataset(
        x_train=np.ascontiguousarray(x[~held_out]),
        dx_train=np.ascontiguousarray(dx[~held_out]),
        x_validation=np.ascontiguousarray(x[held_out]),
        dx_validation=np.ascontiguousarray(dx[held_out]),
        trajectory_train=trajectory[~held_out],
        trajectory_validation=trajectory[held_out],
        state_names=state_names,
        state_units=state_units,
        sha256=sha256.hexdigest(),
    )
