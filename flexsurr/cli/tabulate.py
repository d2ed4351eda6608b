"""Write tables of a study, each as a file for programs and as a page for people."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.products import arguments, text_of
from flexsurr.report.catalogue import TABLES
from flexsurr.report.pages import save_page
from flexsurr.report.tables import TABULATE, save_table


def main(job: Job, results: Path, captions: list[Path], folder: Path) -> None:
    """Write CSV and page of each table of the job to `folder`; `captions` are named as the tables."""
    texts = {caption.stem: text_of(caption) for caption in captions}
    for name, table in job.items():
        frame = TABULATE[name](*arguments(table, results))
        save_table(frame, folder / f"{name}.csv")
        save_page(frame, TABLES[name].title, texts[name], folder / f"{name}.html")


if __name__ == "__main__":
    command(
        main,
        {
            "results": "the folder of all results",
            "captions": "what to see in them …",
            "folder": "of the tables",
        },
    )
