"""Put the tables of all studies below one another."""

from pathlib import Path

import pandas as pd

from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame


def main(job: Job, inputs: list[Path], output: Path) -> None:
    """Write the rows of `inputs`, in their order and to the letter, to `output`."""
    # As text: a number that is read and written again may come out with other digits.
    tables = [pd.read_csv(path, dtype=str, keep_default_na=False) for path in inputs]
    write_frame(output, pd.concat(tables, ignore_index=True))


if __name__ == "__main__":
    command(main, {"inputs": "one table of each study …", "output": "all of them"})
