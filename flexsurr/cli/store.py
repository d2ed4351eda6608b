"""Create the tracking store, once and before anything writes to it."""

from dataclasses import asdict
from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.storage import write_json
from flexsurr.training.tracking import create_store, store_uri


def main(job: Job, output: Path) -> None:
    """Create the store of the job beside `output`, and write there how to reach it."""
    folder = output.parent
    write_json(output, asdict(create_store(store_uri(job["uri"], folder), folder, job["studies"])))


if __name__ == "__main__":
    command(main, {"output": "the address of the store and what is in it"})
