"""Result tables as files."""

from pathlib import Path

import pandas as pd

from flexsurr.storage import replacing
from flexsurr.storage.arrow import read_table


def read_frame(path: Path) -> pd.DataFrame:
    """The frame in a Parquet file."""
    frame: pd.DataFrame = read_table(path).to_pandas(use_threads=False)
    return frame


def write_frame(path: Path, frame: pd.DataFrame) -> None:
    """Write a Parquet file, or by its suffix a CSV, atomically."""
    with replacing(path) as beside:
        if path.suffix == ".csv":
            frame.to_csv(beside, index=False)
        else:
            frame.to_parquet(beside, index=False)
