"""Create the tracking store, once and before anything writes to it."""

import logging
from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.tracking.store import Store, create_store, store_uri, write_store

log = logging.getLogger(__name__)


def main(job: Job, output: Path) -> None:
    """Create the store of the job beside `output`, and write there how to reach it.

    A store that cannot be reached is a warning: its address alone is written, and results are made without
    it. So is a folder that cannot be written to, of which the first job will have more to say.
    """
    folder = output.parent
    uri = store_uri(job["uri"], folder)
    store = create_store(uri, folder, job["studies"]) or Store(uri, {}, {})
    try:
        write_store(output, store)
    except OSError as error:
        log.warning("tracking: %s: %s; results are made without it", output, error.strerror)


if __name__ == "__main__":
    command(main, {"output": "the address of the store and what is in it"})
