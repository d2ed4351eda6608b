"""Reading of Parquet tables, the one way of all of them."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from flexsurr.storage.errors import DamagedFile


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
