"""Shards: whole trajectories of one dataset in a Parquet file, with what made them in its metadata.

Columns: `trajectory` (number within the dataset), `t` [s], the states by name, and their time
derivatives as `d_<state>_dt`.
"""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from flexsurr.storage.arrow import own_table
from flexsurr.storage.atomic import read_bytes, replacing
from flexsurr.storage.errors import DamagedFile

FORMAT_VERSION = 1
METADATA_KEY = b"flexsurr"
Array = NDArray[np.float64]


@dataclass(frozen=True)
class ShardMetadata:
    """What a shard belongs to. `configuration` is the hash of every value its dataset depends on."""

    study: str
    variant: str
    seed: int
    configuration: str
    first: int
    count: int
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]
    failures: tuple[str, ...] = ()
    format_version: int = FORMAT_VERSION


@dataclass(frozen=True)
class Shard:
    """trajectory (m,), t (m,) [s], x (m, d) in the units of the metadata, dx (m, d) in those per second."""

    trajectory: NDArray[np.int64]
    t: Array
    x: Array
    dx: Array
    metadata: ShardMetadata


def write_shard(path: Path, shard: Shard) -> None:
    """Write the shard atomically. Raises ValueError if its columns don't fit each other or its metadata."""
    _check_contents(shard)
    names = _column_names(shard.metadata.state_names)
    columns = [shard.trajectory, shard.t, *shard.x.T, *shard.dx.T]
    table = pa.table(
        {name: np.ascontiguousarray(column) for name, column in zip(names, columns, strict=True)}
    )
    metadata = json.dumps(asdict(shard.metadata), sort_keys=True).encode()
    with replacing(path) as beside:
        pq.write_table(
            table.replace_schema_metadata({METADATA_KEY: metadata}), beside, write_page_checksum=True
        )


def read_shard(path: Path, sha256: str | None = None) -> Shard:
    """The shard at `path`.

    Raises StorageError naming the file if it is missing, damaged, truncated, no shard of this format,
    or (where `sha256` is given) another file than the one that was recorded.
    """
    content = read_bytes(path)
    if sha256 is not None and hashlib.sha256(content).hexdigest() != sha256:
        raise DamagedFile(f"{path}: is not the file that was recorded (its SHA-256 differs)")
    table = own_table(path, content)
    metadata = _read_metadata(path, table)
    expected = _column_names(metadata.state_names)
    if table.column_names != expected:
        raise DamagedFile(f"{path}: has the columns {table.column_names}; expected {expected}")
    columns = {name: table.column(name).to_numpy() for name in expected}
    dimension = len(metadata.state_names)
    shard = Shard(
        trajectory=columns["trajectory"],
        t=columns["t"],
        x=np.column_stack([columns[name] for name in expected[2 : 2 + dimension]]),
        dx=np.column_stack([columns[name] for name in expected[2 + dimension :]]),
        metadata=metadata,
    )
    try:
        _check_contents(shard)
    except ValueError as error:
        raise DamagedFile(f"{path}: {error}") from None
    return shard


def _column_names(state_names: Sequence[str]) -> list[str]:
    return ["trajectory", "t", *state_names, *(f"d_{name}_dt" for name in state_names)]


def _read_metadata(path: Path, table: pa.Table) -> ShardMetadata:
    raw = (table.schema.metadata or {}).get(METADATA_KEY)
    if raw is None:
        raise DamagedFile(f"{path}: a foreign Parquet file, without the metadata of a shard")
    try:
        values: dict[str, Any] = json.loads(raw)
        if values.get("format_version") != FORMAT_VERSION:
            version = values.get("format_version")
            raise DamagedFile(f"{path}: has format version {version}; this program reads {FORMAT_VERSION}")
        for key in ("state_names", "state_units", "failures"):
            values[key] = tuple(values[key])
        return ShardMetadata(**values)
    except (ValueError, TypeError, KeyError, AttributeError):
        raise DamagedFile(f"{path}: its metadata cannot be understood") from None


def _check_contents(shard: Shard) -> None:
    metadata, rows = shard.metadata, len(shard.t)
    dimension = len(metadata.state_names)
    if len(metadata.state_units) != dimension:
        raise ValueError(f"{dimension} states and {len(metadata.state_units)} units")
    if (
        shard.trajectory.shape != (rows,)
        or shard.x.shape != (rows, dimension)
        or shard.dx.shape != shard.x.shape
    ):
        raise ValueError("columns of different lengths")
    if shard.trajectory.dtype != np.int64:
        raise ValueError(f"trajectory numbers of type {shard.trajectory.dtype}; expected int64")
    for name, values in (("t", shard.t), ("states", shard.x), ("derivatives", shard.dx)):
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
