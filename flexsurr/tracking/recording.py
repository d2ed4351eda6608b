"""Runs whose files are there, brought to the page after the event: whole trainings, scores, figures."""

import hashlib
import logging
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from mlflow import MlflowClient
from mlflow.entities import Metric, Run, RunTag

from flexsurr.storage import DamagedFile, StorageError, read_bytes, read_json
from flexsurr.storage.parquet import own_table
from flexsurr.tracking import description
from flexsurr.tracking.description import RUN_KEY
from flexsurr.tracking.page import Page
from flexsurr.tracking.run_files import ARTEFACTS, RunFiles, digest
from flexsurr.tracking.store import Store
from flexsurr.tracking.trial import LOGGED, end, ended_as, keep_files, send, start

log = logging.getLogger(__name__)

SCORED = "flexsurr.scored"  # holds the digest of the scores that the run has
TRIALS = "trials"
FIGURES = "flexsurr.figures"  # holds the digest of the figures that the parent run has
LOSSES = ("train_loss", "validation_loss")


def record(page: Page, study: str, runs: Sequence[RunFiles], figures: Sequence[Path]) -> list[RunFiles]:
    """Log the scores of the `runs` of a study that the page has, and its `figures`; the other runs come back.

    What is there already is not logged again.
    """
    if not page.is_reachable:
        return [run for run in runs if run.is_marked]
    there = _on_the_page(page, study)
    for run in runs:
        known = there.get((run.key, run.fit_digest))
        if known is not None and run.scores.is_file():
            _score(page, run, known)
    parent = page.attempt(lambda client, store: client.get_run(store.parents[study]))
    if parent is not None:
        _keep_figures(page, parent, figures)
        page.attempt(lambda client, _: client.set_tag(parent.info.run_id, TRIALS, str(len(runs))))
    missing = [run for run in runs if (run.key, run.fit_digest) not in there]
    return missing if page.is_reachable else [run for run in missing if run.is_marked]


def log_whole(page: Page, run: RunFiles) -> bool:
    """Log a run from its files as if its training had told of it; whether that went well."""
    try:
        described, losses = run.described, _losses(run)
        began, ended = _times(run)
    except (StorageError, OSError) as error:
        log.warning("tracking: %s", error)
        return False

    def whole(client: MlflowClient, store: Store) -> bool:
        page_run = start(client, store, described, began)
        send(client, page_run, losses)
        keep_files(client, page_run, run, described, [])
        return end(client, page_run, ended_as(run.fit["status"]), run.fit.get("reason") or "", ended)

    done = bool(page.attempt(whole))
    if done:
        run.mark(logged=True)
    return done


def end_sweeps(page: Page, study: str, runs: Iterable[RunFiles]) -> None:
    """End the parent run of a study, and those of its `runs` that a killed job has left RUNNING."""
    ours = {run.key for run in runs}

    def finish(client: MlflowClient, store: Store) -> None:
        experiment, parent = store.experiments[study], store.parents[study]
        for run in _all(client, experiment, "attributes.status = 'RUNNING'"):
            if run.data.tags.get(RUN_KEY) in ours:
                client.set_terminated(run.info.run_id, "KILLED")
        client.set_terminated(parent, "FINISHED")

    page.attempt(finish)


def _on_the_page(page: Page, study: str) -> Mapping[tuple[str, str], Run]:
    """The runs of a study that the page has all of, by their key and the digest of their training."""
    runs = page.attempt(lambda client, store: _all(client, store.experiments[study])) or []
    tagged = [(run.data.tags, run) for run in runs]
    return {(tags[RUN_KEY], tags[LOGGED]): run for tags, run in tagged if RUN_KEY in tags and LOGGED in tags}


def _all(client: MlflowClient, experiment: str, which: str = "") -> list[Run]:
    runs, token = [], None
    while True:
        page = client.search_runs([experiment], which, page_token=token)
        runs += page
        if not (token := page.token):
            return runs


def _times(run: RunFiles) -> tuple[int, int]:
    """When a training began and ended [ms], as its files have it; all that are logged are there."""
    written = {name: (run.folder / name).stat().st_mtime for name in (*ARTEFACTS, "fit.json")}
    return int(1000 * written["parameters.json"]), int(1000 * written["fit.json"])


def _losses(run: RunFiles) -> list[Metric]:
    """The losses of every epoch, at the times at which they came."""
    history, (began, _) = run.folder / "history.parquet", _times(run)
    table = own_table(history, read_bytes(history))
    if not {"epoch", "wall_s", *LOSSES} <= set(table.column_names):
        raise DamagedFile(f"{history}: another's, without the losses of its epochs")
    epochs, wall_s = table.column("epoch").to_pylist(), table.column("wall_s").to_pylist()
    times = [began + int(1000 * wall) for wall in wall_s]
    return [
        Metric(name, value, at, epoch)
        for name in LOSSES
        for epoch, at, value in zip(epochs, times, table.column(name).to_pylist(), strict=True)
    ]


def _score(page: Page, run: RunFiles, known: Run) -> None:
    try:
        scores = digest(run.scores)
        if known.data.tags.get(SCORED) == scores:
            return
        figures = description.metrics(run.described, read_json(run.scores))
    except StorageError as error:
        log.warning("tracking: %s", error)
        return
    metrics = [Metric(name, value, known.info.end_time, 0) for name, value in figures.items()]
    tags = [RunTag(SCORED, scores)]
    page.attempt(lambda client, _: client.log_batch(known.info.run_id, metrics=metrics, tags=tags))


def _keep_figures(page: Page, parent: Run, figures: Sequence[Path]) -> None:
    sha = hashlib.sha256()
    for figure in figures:
        sha.update(figure.name.encode() + b"\0" + read_bytes(figure))
    content = sha.hexdigest()[:16]
    if not figures or parent.data.tags.get(FIGURES) == content:
        return

    def keep(client: MlflowClient, _: Store) -> None:
        for figure in figures:
            client.log_artifact(parent.info.run_id, str(figure), "figures")
        client.set_tag(parent.info.run_id, FIGURES, content)

    page.attempt(keep)
