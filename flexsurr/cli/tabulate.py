"""Write one table of a study, as a file for programs and as a page for people."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.products import arguments, text_of
from flexsurr.report.catalogue import TABLES
from flexsurr.report.pages import save_page
from flexsurr.report.tables import TABULATE, save_table


def main(job: Job, results: Path, caption: Path, output: Path) -> None:
    """Write the page of the job's table, with its caption, to `output`, and its CSV beside it."""
    name = job["table"]
    frame = TABULATE[name](*arguments(job, results))
    save_table(frame, output.with_suffix(".csv"))
    save_page(frame, TABLES[name].title, text_of(caption), output)


if __name__ == "__main__":
    command(
        main,
        {
            "results": "the folder of all results",
            "caption": "what to see in it",
            "output": "the page",
        },
    )
