"""The page of runs: made before the first job, and brought up to date with the files of the results."""

import argparse
import logging
import sqlite3
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from flexsurr import __version__
from flexsurr.cli.command import Job, for_people, for_rules
from flexsurr.config.errors import ConfigurationError
from flexsurr.config.settings import check_address
from flexsurr.storage import StorageError, read_json
from flexsurr.tracking.champion import Champion, Interface, is_registered, register
from flexsurr.tracking.page import Page
from flexsurr.tracking.recording import end_sweeps, log_whole, record
from flexsurr.tracking.run_files import RunFiles, digest, runs_by_study
from flexsurr.tracking.store import (
    Store,
    create_store,
    keep_artefacts_beside,
    read_store,
    store_uri,
    warn,
    write_store,
)

log = logging.getLogger(__name__)


@for_rules(output="the address of the store and what is in it")
def store(job: Job, output: Path) -> None:
    """Create the tracking store, before anything writes to it.

    It lies beside `output`, which says how to reach it. A store that cannot be reached is a warning: its
    address alone is written, and results are made without it. So is a folder that cannot be written to, of
    which the first job will have more to say.
    """
    folder = output.parent
    uri = store_uri(job["uri"], folder)
    store = create_store(uri, folder, job["studies"]) or Store(uri, {}, {})
    try:
        write_store(output, store)
    except OSError as error:
        log.warning("tracking: %s: %s; results are made without it", output, error.strerror)


MAP = "network"
"""The label of the chosen map of a study of samples."""


def _track_arguments(parser: argparse.ArgumentParser) -> None:
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


@for_people(_track_arguments)
def track(results: Path, sync: bool, uri: str | None) -> None:
    """Bring the MLflow page of runs up to date with the results, and say what it lacks.

    Logs scores, figures and champions that the page lacks, and with `sync` whole runs.

    A line for each study says what it lacks then. Raises StorageError if that is so in spite of `sync`, and
    for a folder that holds no results, ConfigurationError for what is no address.
    """
    if not ((results / "runs").is_dir() or (results / "mlflow").is_dir()):
        raise StorageError(
            f"--results: {results} is not allowed; allowed: a folder that holds runs or mlflow"
        )
    if uri is not None:
        try:
            check_address(uri)
        except ValueError as error:
            raise ConfigurationError([f"--uri: {uri!r} is {error}"]) from None
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
        if known is not None and known.uri == store_uri(None, path.parent):
            try:
                keep_artefacts_beside(path.parent)
            except sqlite3.Error as error:
                warn(f"{known.uri}: artefacts are where they were", error)
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
    _register(page, results, study)
    if not sync:
        end_sweeps(page, study, runs)
    lacks = []
    if missing:
        lacks.append(_counted(len(missing)))
    if not page.is_reachable:
        lacks.append("scores, figures and champions")
    if lacks:
        advice = "" if sync else "; flexsurr track --sync logs them"
        yield f"{study}: not logged: {', '.join(lacks)}{advice}"


def _counted(runs: int) -> str:
    return f"{runs} run{'s' * (runs != 1)}"


def _register(page: Page, results: Path, study: str) -> None:
    """Register the surrogates of a study that were chosen last."""
    selection = results / "selected" / f"{study}.json"
    if not (selection.is_file() and page.is_reachable):
        return
    for name, entry in _chosen(selection):
        try:
            _register_one(page, name, study, results / "runs" / entry["run_id"] / "weights.npz", entry)
        # a file that was deleted or damaged since, or a network of the user's own that is not here
        except (StorageError, ConfigurationError, OSError) as error:
            log.warning("tracking: %s: no champion: %s", name, error)


def _register_one(page: Page, name: str, study: str, weights: Path, entry: Mapping[str, Any]) -> None:
    champion = Champion(name, study, entry["run_id"], digest(weights))
    if page.attempt(lambda client, _: is_registered(client, champion)) or not page.is_reachable:
        return
    from flexsurr.served import card, served  # here, for it takes a second that is seldom needed

    model = served(weights)
    interface = Interface(
        model.inputs, model.outputs, model.defaults, model.example, f"flexsurr=={__version__}"
    )
    text = card(model, name, entry)
    page.attempt(lambda client, store: register(client, store, champion, weights, interface, text))


def _chosen(selection: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    """Of each variant the run that the study's rule chooses; of maps the network that flies."""
    study = selection.stem
    for of_what, chosen in read_json(selection).items():
        if "run_id" in chosen:
            if of_what == MAP:
                yield f"{study}-{MAP}", chosen
            continue
        if "chosen" in chosen:
            yield f"{study}-{of_what}", chosen[chosen["chosen"]]
