"""The values of jobs as files: a command line holds no more than 128 KiB, and nobody reads so much in a log.

A file's name holds the hash of its content, so a job whose values change has another file, and Snakemake
sees another parameter. A failed job can be run again by hand from it.
"""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flexsurr.storage import StorageError, read_json, write_json

DIGITS = 10


def job_file(folder: Path, name: str, job: Mapping[str, Any]) -> Path:
    """Where the values `job` of the job `name` (it may hold slashes) stand below `folder`."""
    canonical = json.dumps(job, sort_keys=True)
    return folder / f"{name}-{hashlib.sha256(canonical.encode()).hexdigest()[:DIGITS]}.json"


def write_job(folder: Path, name: str, job: Mapping[str, Any]) -> Path:
    """`job_file`, written if it is not there whole."""
    path = job_file(folder, name, job)
    try:
        is_there = read_json(path) == json.loads(json.dumps(job))
    except StorageError:
        is_there = False
    if not is_there:
        write_json(path, job)
    return path
