"""Make pages for people of tables for programs."""

from pathlib import Path

import pandas as pd

from flexsurr.cli.command import Job, command
from flexsurr.cli.products import text_of
from flexsurr.report.tables import save_page


def main(job: Job, tables: list[Path], captions: list[Path], folder: Path) -> None:
    """Write each of `tables` under its title in the job, with its caption, as a page into `folder`."""
    for title, table, caption in zip(job["titles"], tables, captions, strict=True):
        save_page(pd.read_csv(table), title, text_of(caption), folder / f"{table.stem}.html")


if __name__ == "__main__":
    command(
        main,
        {
            "tables": "the tables …",
            "captions": "what to see in each …",
            "folder": "where the pages go",
        },
    )
