"""Bring the page of runs up to date with the files of the results, and say what it lacks."""

import argparse
import logging
import sys
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

from flexsurr.cli.command import personal
from flexsurr.storage import StorageError
from flexsurr.tracking.page import Page
from flexsurr.tracking.recording import end_sweeps, log_whole, record
from flexsurr.tracking.run_files import RunFiles, runs_by_study
from flexsurr.tracking.store import Store, create_store, read_store, store_uri, write_store

log = logging.getLogger(__name__)


def arguments(parser: argparse.ArgumentParser) -> None:
    """The results, and what is to be done about what the page lacks."""
    parser.add_argument(
        "--results", type=Path, default=Path("results"), metavar="FOLDER", help="by default results"
    )
    parser.add_argument(
        "--sync", action="store_true", help="log the runs that were trained while the store was out of reach"
    )
    parser.add_argument(
        "--uri",
        metavar="ADDRESS",
        help="of the store, which is made if need be; by default the one that the last snakemake had",
    )


def main(results: Path, sync: bool, uri: str | None) -> None:
    """Log scores and figures that the page lacks, and with `sync` whole runs.

    A line for each study says what it lacks then. Raises StorageError if that is so in spite of `sync`.
    """
    logging.basicConfig(level=logging.INFO, stream=sys.stderr, format="%(message)s")
    runs = runs_by_study(results / "runs")
    store = _store(results / "mlflow" / "store.json", runs, sync, uri)
    page = Page(store)
    # others were made by an earlier configuration; --sync knows all
    known = set(store.experiments) if store is not None and page.is_reachable else set(runs)
    studies = [study for study in runs if study in known]
    lacking = [line for study in studies for line in _brought(page, results, study, runs[study], sync)]
    for line in lacking:
        print(f"tracking: {line}", file=sys.stderr)
    if sync and lacking:
        raise StorageError(f"{results}: not all of it is on the page")


def _store(path: Path, studies: Collection[str], sync: bool, uri: str | None) -> Store | None:
    """The store of the results; with `sync`, or at another address, what is missing of it is made."""
    known = read_store(path) if path.is_file() else None
    if not sync and uri is None:
        return known
    address = store_uri(uri or (known.uri if known else None), path.parent)
    store = create_store(address, path.parent, sorted({*studies, *(known.experiments if known else ())}))
    if store is not None:
        write_store(path, store)
    return store


def _brought(page: Page, results: Path, study: str, runs: Sequence[RunFiles], sync: bool) -> Iterator[str]:
    """Bring one study to the page; a line for what it lacks then."""
    figures = sorted((results / "figures" / study).glob("*.png"))
    missing = record(page, study, runs, figures)
    if sync and missing:
        logged = [run for run in missing if log_whole(page, run)]
        log.info("tracking: %s: %s logged from their files", study, _counted(len(logged)))
        missing = record(page, study, runs, figures)
    if not sync:
        end_sweeps(page, study, runs)
    lacks = []
    if missing:
        lacks.append(_counted(len(missing)))
    if not page.is_reachable:
        lacks.append("scores and figures")
    if lacks:
        yield f"{study}: not logged: {', '.join(lacks)}; flexsurr track --sync logs them"


def _counted(runs: int) -> str:
    return f"{runs} run{'s' * (runs != 1)}"


if __name__ == "__main__":
    personal(main, arguments)
