"""Write tables of a study that read the same, as files for programs and as pages for people."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.products import arguments, text_of
from flexsurr.report.catalogue import TABLES
from flexsurr.report.tables import TABULATE, save_page, save_table


def main(job: Job, inputs: list[Path], captions: list[Path], folder: Path) -> None:
    """Write the CSV of each table that the job names into `folder`, and its page with its caption."""
    for name, caption in zip(job["tables"], captions, strict=True):
        table = TABLES[name]
        frame = TABULATE[name](*arguments(table.reads, job, inputs))
        save_table(frame, folder / f"{name}.csv")
        save_page(frame, table.title, text_of(caption), folder / f"{name}.html")


if __name__ == "__main__":
    command(
        main,
        {
            "inputs": "what they show …",
            "captions": "what to see in each …",
            "folder": "where they go",
        },
    )
