"""Make a page for people of a table for programs."""

from pathlib import Path

import pandas as pd

from flexsurr.cli.command import Job, command
from flexsurr.report import save_page


def main(job: Job, csv: Path, caption: Path, page: Path) -> None:
    """Write the table `csv` under the job's title, with its caption, to `page`."""
    text = " ".join(caption.read_text(encoding="utf-8").split())
    save_page(pd.read_csv(csv), job["title"], text, page)


if __name__ == "__main__":
    command(main, {"csv": "the table", "caption": "what to see in it", "page": "the page"})
