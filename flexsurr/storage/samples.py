"""Samples of a function y = g(u): shards in Parquet with what made them in their metadata.

Columns: `sample` (number within the dataset), the inputs and the outputs by name.
"""

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
from flexsurr.storage.errors import StorageError

FORMAT = "flexsurr samples 1"
METADATA_KEY = b"flexsurr"
Array = NDArray[np.float64]


@dataclass(frozen=True)
class SampleMetadata:
    """What samples belong to. `configuration` is the hash of every value that they depend on.

    Every input was drawn between `input_low` and `input_high`, in its unit.
    """

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
    format: str = FORMAT


@dataclass(frozen=True, eq=False)
class Samples:
    """Inputs u (m, n) and outputs y (m, k) in the units of the metadata, numbered from `metadata.first`."""

    u: Array
    y: Array
    metadata: SampleMetadata


def write_samples(path: Path, samples: Samples) -> None:
    """Write one shard atomically. Raises ValueError for arrays that don't fit their metadata."""
    _check(samples)
    metadata = samples.metadata
    numbers = np.arange(metadata.first, metadata.first + metadata.count)
    columns = [numbers, *samples.u.T, *samples.y.T]
    table = pa.table(
        {name: np.ascontiguousarray(c) for name, c in zip(_columns(metadata), columns, strict=True)}
    )
    header = json.dumps(asdict(metadata), sort_keys=True).encode()
    with replacing(path) as beside:
        pq.write_table(
            table.replace_schema_metadata({METADATA_KEY: header}), beside, write_page_checksum=True
        )


def read_samples(path: Path) -> Samples:
    """The shard at `path`. Raises StorageError naming a file that is missing, damaged or foreign."""
    table = own_table(path, read_bytes(path))
    metadata = _metadata(path, table)
    names = _columns(metadata)
    if table.column_names != names:
        raise StorageError(f"{path}: has the columns {table.column_names}; expected {names}")
    inputs = 1 + len(metadata.input_names)
    samples = Samples(
        np.column_stack([table.column(name).to_numpy() for name in names[1:inputs]]),
        np.column_stack([table.column(name).to_numpy() for name in names[inputs:]]),
        metadata,
    )
    try:
        _check(samples)
    except ValueError as error:
        raise StorageError(f"{path}: {error}") from None
    return samples


def read_all_samples(paths: Sequence[Path], configuration: str, total: int) -> Samples:
    """All shards of one dataset as one. Raises StorageError naming what is missing or foreign."""
    shards = []
    for path in paths:
        samples = read_samples(path)
        if samples.metadata.configuration != configuration:
            raise StorageError(
                f"{path}: belongs to the configuration {samples.metadata.configuration}; "
                f"expected {configuration}"
            )
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
    metadata = SampleMetadata(**{**asdict(shards[0].metadata), "first": 0, "count": total})
    return Samples(
        np.concatenate([samples.u for samples in shards]),
        np.concatenate([samples.y for samples in shards]),
        metadata,
    )


def _columns(metadata: SampleMetadata) -> list[str]:
    return ["sample", *metadata.input_names, *metadata.output_names]


def _metadata(path: Path, table: pa.Table) -> SampleMetadata:
    raw = (table.schema.metadata or {}).get(METADATA_KEY)
    try:
        values: dict[str, Any] = json.loads(raw or b"{}")
        if values.get("format") != FORMAT:
            raise StorageError(f"{path}: format {values.get('format')!r}, expected {FORMAT!r}")
        for key in values:
            values[key] = tuple(values[key]) if isinstance(values[key], list) else values[key]
        return SampleMetadata(**values)
    except (ValueError, TypeError, AttributeError):
        raise StorageError(f"{path}: its metadata cannot be understood") from None


def _check(samples: Samples) -> None:
    metadata = samples.metadata
    shapes = (metadata.count, len(metadata.input_names)), (metadata.count, len(metadata.output_names))
    if (samples.u.shape, samples.y.shape) != shapes:
        raise ValueError(f"arrays of the shapes {samples.u.shape} and {samples.y.shape}; expected {shapes}")
    for name, array in (("inputs", samples.u), ("outputs", samples.y)):
        if array.dtype != np.float64 or not np.isfinite(array).all():
            raise ValueError(f"{name} that are not finite numbers")
