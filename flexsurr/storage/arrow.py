"""Reading of Parquet tables, the one way of all of them."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq


def read_table(source: Path | bytes) -> pa.Table:
    """The table in a file or in its content, checksums verified where there are some.

    Without Arrow's threads: our tables are small, and on a busy machine a process that ends while they start
    is aborted ("terminate called without an active exception"). Raises ArrowException or OSError.
    """
    opened = pa.BufferReader(source) if isinstance(source, bytes) else source
    with pq.ParquetFile(opened, page_checksum_verification=True) as file:
        return file.read(use_threads=False)
