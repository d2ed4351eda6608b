"""Write one table of a study, as a file for programs and as a page for people."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.products import arguments
from flexsurr.report import TABLES, save_page, save_table


def main(job: Job, inputs: list[Path], caption: Path, csv: Path, page: Path) -> None:
    """Write the table that the job names to `csv`, and with its caption to `page`."""
    table = TABLES[job["table"]]
    frame = table.make(*arguments(table.reads, job, inputs))
    save_table(frame, csv)
    save_page(frame, table.title, " ".join(caption.read_text(encoding="utf-8").split()), page)


if __name__ == "__main__":
    command(
        main,
        {
            "inputs": "what it shows …",
            "caption": "what to see in it",
            "csv": "the table",
            "page": "the page",
        },
    )
