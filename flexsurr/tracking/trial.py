"""A training as the page sees it: a run that begins, tells its losses, ends with its figures and files."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import psutil
from mlflow import MlflowClient
from mlflow.entities import Metric, Param, RunTag
from mlflow.exceptions import MlflowException
from mlflow.utils.mlflow_tags import MLFLOW_PARENT_RUN_ID

from flexsurr.tracking import description
from flexsurr.tracking.description import RUN_KEY, Described
from flexsurr.tracking.page import Page, signals_wait
from flexsurr.tracking.run_files import ARTEFACTS, RunFiles
from flexsurr.tracking.store import Store

LOGGED = "flexsurr.logged"  # holds the digest of the training that the run has all of
REASON = "reason"
BATCH = 1000  # MLflow takes no more metrics at once
ROOM = 50  # in a batch, for what is not a loss
LONGEST_WAIT_S = 10.0  # between batches, so that a person can watch
MEGABYTE = 1e6


class Machine:
    """Samples of the processor and the memory since the last one; each takes a fraction of a millisecond."""

    def __init__(self) -> None:
        self._process = psutil.Process()
        # The first call has nothing to compare with.
        psutil.cpu_percent()
        self._process.cpu_percent()

    def sample(self) -> dict[str, float]:
        """Load and memory of the machine, and those of this process (100 % is one core)."""
        memory = psutil.virtual_memory()
        return {
            "system/cpu_utilization_percentage": psutil.cpu_percent(),
            "system/system_memory_usage_megabytes": memory.used / MEGABYTE,
            "system/system_memory_usage_percentage": memory.percent,
            "system/process_cpu_percentage": self._process.cpu_percent(),
            "system/process_memory_megabytes": self._process.memory_info().rss / MEGABYTE,
        }


@dataclass
class TrackedRun:
    """What a running trial tells the page. `status` and `reason` become those of its run at its end."""

    status: str = "finished"
    reason: str = ""
    _report: Callable[[Sequence[Metric]], None] | None = None
    _keep: Callable[[Sequence[Metric]], None] | None = None
    _waiting: list[Metric] = field(default_factory=list)
    _last_sent_s: float = field(default_factory=time.monotonic)
    _machine: Machine = field(default_factory=Machine)
    _samples: int = 0

    def epoch(self, epoch: int, train_loss: float, validation_loss: float) -> None:
        """Losses of one epoch, sent with those of others in batches."""
        if self._report is None:
            return
        now = _milliseconds()
        self._waiting.append(Metric("train_loss", train_loss, now, epoch))
        self._waiting.append(Metric("validation_loss", validation_loss, now, epoch))
        if len(self._waiting) >= BATCH - ROOM or time.monotonic() - self._last_sent_s > LONGEST_WAIT_S:
            self.send()

    def send(self) -> None:
        """Send the losses that wait."""
        if self._waiting and self._report is not None:
            self._report(self._taken())

    def keep(self) -> None:
        """Send what waits, and the figures and files in the run's folder, which are all there now."""
        if self._keep is not None:
            self._keep(self._taken())

    def _taken(self) -> list[Metric]:
        """What waits, and what the machine does meanwhile."""
        now = _milliseconds()
        taken, self._waiting, self._last_sent_s = self._waiting, [], time.monotonic()
        taken += [Metric(name, value, now, self._samples) for name, value in self._machine.sample().items()]
        self._samples += 1
        return taken


@contextmanager
def tracked(store: Store | None, described: Described, folder: Path) -> Iterator[TrackedRun]:
    """A child run of the study's sweeps for the time of the block; without a store, a trial untold.

    `described` is what the parameters.json in `folder` says. A run of the same key that an earlier, killed
    job left RUNNING is ended and deleted. The run ends FINISHED, also where it was stopped as hopeless, or
    FAILED where the trial says so or an exception passes, both with their reason as a tag, or KILLED where
    the process is told to stop. Where the page lacks any of it, `folder` holds a file that says so.
    """
    trial, files = TrackedRun(), RunFiles(folder)
    page = Page(store)
    run = None
    status, logged = "KILLED", False

    def keep(waiting: Sequence[Metric]) -> None:
        nonlocal logged
        logged = bool(page.attempt(lambda client, _: keep_files(client, run, files, described, waiting)))

    try:
        with signals_wait():
            run = page.attempt(lambda client, store: start(client, store, described))
        if run is not None:
            trial._report = lambda metrics: page.attempt(lambda client, _: send(client, run, metrics))
            trial._keep = keep
        yield trial
        status = ended_as(trial.status)
    except Exception as error:
        status, trial.reason = "FAILED", f"{type(error).__name__}: {error}"
        raise
    finally:
        with signals_wait():
            if run is not None:
                trial.send()
                page.insist(lambda client, _: end(client, run, status, trial.reason))
            files.mark(logged)


def start(client: MlflowClient, store: Store, described: Described, since: int | None = None) -> str:
    """A new run of the page, RUNNING since a time [ms]; what killed jobs have left of it goes."""
    study, key = described["study"], described["run_id"]
    experiment = store.experiments[study]
    for run in client.search_runs([experiment], f"tags.`{RUN_KEY}` = '{key}'"):
        if run.info.status == "RUNNING":
            client.set_terminated(run.info.run_id, "KILLED")
        if run.info.status == "RUNNING" or (run.info.status == "FINISHED" and LOGGED not in run.data.tags):
            client.delete_run(run.info.run_id)
    tags = {**description.tags(described), MLFLOW_PARENT_RUN_ID: store.parents[study]}
    created: str = client.create_run(experiment, start_time=since, tags=tags).info.run_id
    client.log_batch(created, params=description.parameters(described))
    _log_dataset(client, created, described)
    return created


def _log_dataset(client: MlflowClient, run: str, described: Described) -> None:
    """Another trial may note the same dataset at this moment; the second time it is there."""
    try:
        client.log_inputs(run, [description.dataset(described)])
    except MlflowException:
        client.log_inputs(run, [description.dataset(described)])


def send(client: MlflowClient, run: str, metrics: Sequence[Metric]) -> None:
    """Any number of metrics, in batches."""
    for first in range(0, len(metrics), BATCH):
        client.log_batch(run, metrics=metrics[first : first + BATCH])


def keep_files(
    client: MlflowClient, run: str | None, files: RunFiles, described: Described, waiting: Sequence[Metric]
) -> bool:
    """Log what waits, the files as artefacts, and last the figures with the tag that all of it is there."""
    for name in ARTEFACTS:
        client.log_artifact(run, str(files.folder / name))
    now = _milliseconds()
    figures = description.metrics(described, files.fit)
    metrics = [*waiting, *(Metric(name, value, now, 0) for name, value in figures.items())]
    *full, last = [metrics[first : first + BATCH] for first in range(0, max(len(metrics), 1), BATCH)]
    for batch in full:
        client.log_batch(run, metrics=batch)
    size = [Param("parameter_count", str(files.fit["parameters"]))] if "parameters" in files.fit else []
    client.log_batch(run, metrics=last, params=size, tags=[RunTag(LOGGED, files.fit_digest)])
    return True


def ended_as(status: str) -> str:
    """What the page calls the status of a trial."""
    return "FAILED" if status == "failed" else "FINISHED"


def end(client: MlflowClient, run: str, status: str, reason: str, at: int | None = None) -> bool:
    """End a run at a time [ms], by default now."""
    if reason:
        client.set_tag(run, REASON, reason)
    client.set_terminated(run, status, at)
    return True


def _milliseconds() -> int:
    return int(time.time() * 1000)
