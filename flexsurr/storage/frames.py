"""Result tables as files."""

import io
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from flexsurr.storage import DamagedFile, read_bytes, replacing
from flexsurr.storage.parquet import own_table

NAME = b"flexsurr"  # under which a Parquet file says what it was written as


def read_frame(path: Path) -> pd.DataFrame:
    """The frame in a Parquet file that `write_frame` wrote as such; DamagedFile naming any other."""
    table = own_table(path, read_bytes(path))
    written_as = (table.schema.metadata or {}).get(NAME, b"").decode(errors="replace")
    if written_as != _name(path):
        raise DamagedFile(f"{path}: another's: it was written as {written_as or 'no table of results'}")
    frame: pd.DataFrame = table.to_pandas(use_threads=False)
    return frame


def read_text_frame(path: Path, **options: Any) -> pd.DataFrame:
    """The frame in a CSV, read with the `options` of pandas; DamagedFile naming what is no table."""
    content = read_bytes(path)
    try:
        if not content.endswith(b"\n"):
            raise ValueError("its last line has no end")
        frame: pd.DataFrame = pd.read_csv(io.BytesIO(content), **options)
        return frame
    except ValueError as error:
        raise DamagedFile(f"{path}: damaged or truncated, not a table: {error}") from None


def write_frame(path: Path, frame: pd.DataFrame) -> None:
    """Write a Parquet file, or by its suffix a CSV, atomically."""
    with replacing(path) as beside:
        if path.suffix == ".csv":
            frame.to_csv(beside, index=False)
            return
        # Without what pandas would add, which it does not survive to find damaged.
        named = pa.Table.from_pandas(frame, preserve_index=False).replace_schema_metadata({NAME: _name(path)})
        pq.write_table(named, beside, write_page_checksum=True)


def _name(path: Path) -> str:
    """Folder and file; what is above them may move."""
    return "/".join(path.absolute().parts[-2:])
