"""Put the tables of all studies below one another."""

from pathlib import Path

import pandas as pd

from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import read_text_frame, write_frame


def main(job: Job, inputs: list[Path], folder: Path) -> None:
    """Write `inputs` of the same name below one another, to the letter, to that name in `folder`."""
    for name in dict.fromkeys(path.name for path in inputs):
        # As text: a number that is read and written again may come out with other digits.
        tables = [
            read_text_frame(path, dtype=str, keep_default_na=False) for path in inputs if path.name == name
        ]
        write_frame(folder / name, pd.concat(tables, ignore_index=True))


if __name__ == "__main__":
    command(main, {"inputs": "the tables of each study …", "folder": "where all of them go"})
