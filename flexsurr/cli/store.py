"""Create the tracking store, once and before anything writes to it."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.training.tracking import create_store, store_uri, write_store


def main(job: Job, output: Path) -> None:
    """Create the store of the job beside `output`, and write there how to reach it.

    A store that cannot be reached is a warning: nothing is written, and results are made without it.
    """
    folder = output.parent
    store = create_store(store_uri(job["uri"], folder), folder, job["studies"])
    if store is None:
        output.unlink(missing_ok=True)
    else:
        write_store(output, store)


if __name__ == "__main__":
    command(main, {"output": "the address of the store and what is in it"})
