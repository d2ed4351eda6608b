"""The files of a run, and whether the page has what they say."""

import hashlib
import logging
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from flexsurr.storage import StorageError, read_bytes, read_json

log = logging.getLogger(__name__)

UNLOGGED = "unlogged"
"""An empty file in the folder of a run that the page lacks, or has but in part."""
DESCRIBED = ("run_id", "study", "variant", "dataset", "dataset_sha256", "trial")
ARTEFACTS = ("parameters.json", "weights.npz", "history.parquet")


@dataclass(frozen=True)
class RunFiles:
    """The folder of a run whose training has ended. Reading raises StorageError, naming the file."""

    folder: Path

    @property
    def key(self) -> str:
        """The run_id."""
        return self.folder.name

    @property
    def described(self) -> dict[str, Any]:
        """What it was trained on, and how."""
        return read_json(self.folder / "parameters.json", DESCRIBED)

    @cached_property
    def fit(self) -> dict[str, Any]:
        """What training says of it."""
        return read_json(self.folder / "fit.json", ("run_id", "study", "status"))

    @cached_property
    def fit_digest(self) -> str:
        """By which the page's run is known to be of this very training."""
        return digest(self.folder / "fit.json")

    @property
    def scores(self) -> Path:
        """Where its scores are, once they are."""
        return self.folder / "metrics.json"

    @property
    def is_marked(self) -> bool:
        """Whether the page was out of reach when the run was made."""
        return (self.folder / UNLOGGED).exists()

    def mark(self, logged: bool) -> None:
        """Note whether the page has all of it; a folder that may not be written to stays as it is."""
        try:
            if logged:
                (self.folder / UNLOGGED).unlink(missing_ok=True)
            elif (self.folder / "fit.json").exists():
                (self.folder / UNLOGGED).touch()
        except OSError as error:
            log.warning("tracking: %s: %s", self.folder / UNLOGGED, error.strerror)


def digest(path: Path) -> str:
    """Sixteen hex digits of the hash of a file."""
    return hashlib.sha256(read_bytes(path)).hexdigest()[:16]


def runs_by_study(runs: Path) -> dict[str, list[RunFiles]]:
    """The trained runs below `runs` by their study; one that cannot be read is a warning."""
    found: dict[str, list[RunFiles]] = {}
    for run in _trained(runs):
        try:
            found.setdefault(run.fit["study"], []).append(run)
        except StorageError as error:
            log.warning("tracking: %s", error)
    return found


def _trained(runs: Path) -> Iterator[RunFiles]:
    for fit in sorted(runs.glob("*/fit.json")):
        yield RunFiles(fit.parent)
