"""Shards in Parquet: whole trajectories, or samples of a function y = g(u), with what made them as metadata.

Columns of trajectories: `trajectory` (number within the dataset), `t` [s], the states by name, their time
derivatives as `d_<state>_dt`, and inputs by name where there are any. Columns of samples: `sample` (number),
the inputs and the outputs by name.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from flexsurr.storage.files import DamagedFile, StorageError, read_bytes, replacing

FORMAT_VERSION = 1
METADATA_KEY = b"flexsurr"
Array = NDArray[np.float64]


@dataclass(frozen=True)
class ShardMetadata:
    """What a shard belongs to. `configuration` is the hash of every value its dataset depends on.

    Inputs are generalised forces on the second half of the states, one for each of these.
    """

    study: str
    variant: str
    seed: int
    configuration: str
    first: int
    count: int
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]
    failures: tuple[str, ...] = ()
    input_names: tuple[str, ...] = ()
    input_units: tuple[str, ...] = ()
    format_version: int = FORMAT_VERSION

    @property
    def columns(self) -> list[str]:
        """The names of the columns, in their order."""
        rates = (f"d_{name}_dt" for name in self.state_names)
        return ["trajectory", "t", *self.state_names, *rates, *self.input_names]


@dataclass(frozen=True)
class Shard:
    """trajectory (m,), t (m,) [s], x (m, d) in the units of the metadata, dx (m, d) in those per second.

    Where there are inputs `u` (m, d/2), dx is what is left without them: a field of the states alone.
    """

    trajectory: NDArray[np.int64]
    t: Array
    x: Array
    dx: Array
    metadata: ShardMetadata
    u: Array | None = None

    @property
    def inputs(self) -> Array:
        """The inputs (m, d/2), or none of them (m, 0)."""
        return np.empty((len(self.t), 0)) if self.u is None else self.u


@dataclass(frozen=True)
class SampleMetadata:
    """The same of samples. Every input was drawn between `input_low` and `input_high`, in its unit."""

    study: str
    sampling: str
    seed: int
    configuration: str
    first: int
    count: int
    input_names: tuple[str, ...]
    input_units: tuple[str, ...]
    input_low: tuple[float, ...]
    input_high: tuple[float, ...]
    output_names: tuple[str, ...]
    output_units: tuple[str, ...]
    format_version: int = FORMAT_VERSION

    @property
    def columns(self) -> list[str]:
        """The names of the columns, in their order."""
        return ["sample", *self.input_names, *self.output_names]


@dataclass(frozen=True, eq=False)
class Samples:
    """Inputs u (m, n) and outputs y (m, k) in the units of the metadata, numbered from `metadata.first`."""

    u: Array
    y: Array
    metadata: SampleMetadata


MetadataT = TypeVar("MetadataT", ShardMetadata, SampleMetadata)


def write_shard(path: Path, shard: Shard) -> None:
    """Write the shard atomically. Raises ValueError if its columns don't fit each other or its metadata."""
    _check_shard(shard)
    _write(path, [shard.trajectory, shard.t, *shard.x.T, *shard.dx.T, *shard.inputs.T], shard.metadata)


def read_shard(path: Path, sha256: str | None = None) -> Shard:
    """The shard at `path`.

    Raises StorageError naming the file if it is missing, damaged, truncated, no shard of this format,
    or (where `sha256` is given) another file than the one that was recorded.
    """
    columns, metadata = _read(path, ShardMetadata, sha256)
    names, dimension = metadata.columns, len(metadata.state_names)
    shard = Shard(
        trajectory=columns["trajectory"],
        t=columns["t"],
        x=_side_by_side(columns, names[2 : 2 + dimension]),
        dx=_side_by_side(columns, names[2 + dimension : 2 + 2 * dimension]),
        metadata=metadata,
        u=_side_by_side(columns, metadata.input_names) if metadata.input_names else None,
    )
    try:
        _check_shard(shard)
    except ValueError as error:
        raise DamagedFile(f"{path}: {error}") from None
    return shard


def write_samples(path: Path, samples: Samples) -> None:
    """Write one shard atomically. Raises ValueError for arrays that don't fit their metadata."""
    _check_samples(samples)
    first, count = samples.metadata.first, samples.metadata.count
    _write(path, [np.arange(first, first + count), *samples.u.T, *samples.y.T], samples.metadata)


def read_samples(path: Path) -> Samples:
    """The shard at `path`. Raises StorageError naming a file that is missing, damaged or foreign."""
    columns, metadata = _read(path, SampleMetadata)
    inputs, outputs = metadata.input_names, metadata.output_names
    samples = Samples(_side_by_side(columns, inputs), _side_by_side(columns, outputs), metadata)
    try:
        _check_samples(samples)
    except ValueError as error:
        raise DamagedFile(f"{path}: {error}") from None
    return samples


def read_all_samples(paths: Sequence[Path], configuration: str, total: int) -> Samples:
    """All shards of one dataset as one. Raises StorageError naming what is missing or foreign."""
    shards = []
    for path in paths:
        samples = read_samples(path)
        if (found := samples.metadata.configuration) != configuration:
            raise DamagedFile(f"{path}: belongs to the configuration {found}; expected {configuration}")
        shards.append(samples)
    shards.sort(key=lambda samples: samples.metadata.first)
    reached = 0
    for samples in shards:
        if samples.metadata.first != reached:
            raise StorageError(
                f"samples {reached} to {samples.metadata.first - 1} of {configuration} are missing or doubled"
            )
        reached += samples.metadata.count
    if reached != total:
        raise StorageError(f"{reached} samples of {configuration}; expected {total}")
    return Samples(
        np.concatenate([samples.u for samples in shards]),
        np.concatenate([samples.y for samples in shards]),
        replace(shards[0].metadata, first=0, count=total),
    )


def _write(path: Path, columns: Iterable[np.ndarray], metadata: ShardMetadata | SampleMetadata) -> None:
    table = pa.table(
        {name: np.ascontiguousarray(column) for name, column in zip(metadata.columns, columns, strict=True)}
    )
    header = json.dumps(asdict(metadata), sort_keys=True).encode()
    with replacing(path) as beside:
        pq.write_table(
            table.replace_schema_metadata({METADATA_KEY: header}), beside, write_page_checksum=True
        )


def _read(
    path: Path, kind: type[MetadataT], sha256: str | None = None
) -> tuple[dict[str, np.ndarray], MetadataT]:
    """The columns and the metadata of a shard of one kind."""
    content = read_bytes(path)
    if sha256 is not None and hashlib.sha256(content).hexdigest() != sha256:
        raise DamagedFile(f"{path}: is not the file that was recorded (its SHA-256 differs)")
    table = own_table(path, content)
    metadata = _metadata(path, table, kind)
    if table.column_names != metadata.columns:
        raise DamagedFile(f"{path}: has the columns {table.column_names}; expected {metadata.columns}")
    return {name: table.column(name).to_numpy() for name in metadata.columns}, metadata


def _metadata(path: Path, table: pa.Table, kind: type[MetadataT]) -> MetadataT:
    raw = (table.schema.metadata or {}).get(METADATA_KEY)
    if raw is None:
        raise DamagedFile(f"{path}: a foreign Parquet file, without the metadata of a shard")
    try:
        values: dict[str, Any] = json.loads(raw)
        if (version := values.get("format_version")) != FORMAT_VERSION:
            raise DamagedFile(f"{path}: has format version {version}; this program reads {FORMAT_VERSION}")
        whole: dict[str, Any] = {
            key: tuple(value) if isinstance(value, list) else value for key, value in values.items()
        }
        return kind(**whole)
    except (ValueError, TypeError, AttributeError):
        raise DamagedFile(f"{path}: its metadata cannot be understood") from None


def _side_by_side(columns: Mapping[str, np.ndarray], names: Sequence[str]) -> Array:
    return np.column_stack([columns[name] for name in names])


def _check_shard(shard: Shard) -> None:
    metadata, rows = shard.metadata, len(shard.t)
    dimension = len(metadata.state_names)
    if len(metadata.state_units) != dimension:
        raise ValueError(f"{dimension} states and {len(metadata.state_units)} units")
    inputs = len(metadata.input_names)
    if len(metadata.input_units) != inputs or 2 * inputs not in (0, dimension):
        raise ValueError(f"{inputs} inputs in {len(metadata.input_units)} units for {dimension} states")
    if (
        shard.trajectory.shape != (rows,)
        or shard.x.shape != (rows, dimension)
        or shard.dx.shape != shard.x.shape
        or shard.inputs.shape != (rows, inputs)
    ):
        raise ValueError("columns of different lengths")
    if shard.trajectory.dtype != np.int64:
        raise ValueError(f"trajectory numbers of type {shard.trajectory.dtype}; expected int64")
    numbers = {"t": shard.t, "states": shard.x, "derivatives": shard.dx, "inputs": shard.inputs}
    for name, values in numbers.items():
        if values.dtype != np.float64:
            raise ValueError(f"{name} of type {values.dtype}; expected float64")
        if not np.isfinite(values).all():
            raise ValueError(f"{name} that are not finite")
    if rows and np.any(np.diff(shard.trajectory) < 0):
        raise ValueError("trajectories out of order")
    present = np.unique(shard.trajectory)
    expected = np.arange(metadata.first, metadata.first + metadata.count)
    if not np.array_equal(present, expected):
        raise ValueError(f"trajectories {present.tolist()}; expected {expected.tolist()}")


def _check_samples(samples: Samples) -> None:
    metadata = samples.metadata
    shapes = (metadata.count, len(metadata.input_names)), (metadata.count, len(metadata.output_names))
    if (samples.u.shape, samples.y.shape) != shapes:
        raise ValueError(f"arrays of the shapes {samples.u.shape} and {samples.y.shape}; expected {shapes}")
    for name, array in (("inputs", samples.u), ("outputs", samples.y)):
        if array.dtype != np.float64 or not np.isfinite(array).all():
            raise ValueError(f"{name} that are not finite numbers")


def read_table(content: bytes) -> pa.Table:
    """The table in the `content` of a file, checksums verified where there are some.

    Without Arrow's threads: our tables are small, and on a busy machine a process that ends while they start
    is aborted ("terminate called without an active exception"). Raises ArrowException, OSError or ValueError.
    """
    with pq.ParquetFile(pa.BufferReader(content), page_checksum_verification=True) as file:
        table = file.read(use_threads=False)
    _ = table.column_names  # of which Arrow reads the letters only when it is asked for them
    return table


def own_table(path: Path, content: bytes) -> pa.Table:
    """The table in the `content` of the file at `path`, which flexsurr wrote. Raises DamagedFile."""
    try:
        return read_table(content)
    except (pa.ArrowException, OSError, ValueError) as error:
        reason = str(error).splitlines()[0]
        raise DamagedFile(f"{path}: damaged or truncated, not a readable Parquet file: {reason}") from None
