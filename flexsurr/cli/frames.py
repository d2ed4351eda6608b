"""Result tables as files."""

from pathlib import Path

import pandas as pd

from flexsurr.storage import replacing


def write_frame(path: Path, frame: pd.DataFrame) -> None:
    """Write a Parquet file, or by its suffix a CSV, atomically."""
    with replacing(path) as beside:
        if path.suffix == ".csv":
            frame.to_csv(beside, index=False)
        else:
            frame.to_parquet(beside, index=False)
