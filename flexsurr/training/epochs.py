"""Epoch after epoch, whatever is fitted: validated, timed, reported, kept from a kill, and ended."""

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np

from flexsurr.config.trial import GiveUp, Iterative
from flexsurr.simulation.rhs import Array
from flexsurr.training.checkpoint import read_checkpoint, remove_checkpoint, write_checkpoint
from flexsurr.training.optimiser import Optimiser
from flexsurr.training.progress import Progress

CHECKPOINT_EVERY_S = 5.0

Report = Callable[[int, float, float, float], None]


class Loss(Protocol):
    """The nmse as a function of the weights."""

    def loss(self, parameters: Array) -> float:
        """The nmse at `parameters`."""
        ...


@dataclass(frozen=True)
class Limits:
    """When to stop: after `epochs`, after `patience` of them without better validation, after a time.

    `time_limit_s` is processor time, so that other work on the machine does not change a result. A trial
    that is hopeless by `give_up` ends before.
    """

    epochs: int
    patience: int | None = None
    time_limit_s: float | None = None
    give_up: GiveUp | None = None

    @classmethod
    def of(cls, trial: Iterative) -> "Limits":
        """Those of a trial."""
        return cls(trial.epochs, trial.patience, trial.time_limit_s, trial.give_up)


Status = Literal["finished", "stopped", "failed"]


@dataclass(frozen=True)
class Ending:
    """How training ended: at its limits or, for a `reason`, stopped as hopeless, or failed."""

    status: Status = "finished"
    reason: str = ""

    @classmethod
    def of_all(cls, endings: Mapping[str, "Ending"]) -> "Ending":
        """That of several networks together: the worst of theirs, with every reason and whose it is."""
        named = {name: ending for name, ending in endings.items() if ending.reason}
        if not named or len(endings) == 1:
            return next(iter(named.values()), cls())
        status: Status = "failed" if any(each.status == "failed" for each in named.values()) else "stopped"
        return cls(status, "; ".join(f"{name}: {ending.reason}" for name, ending in named.items()))


def run_epochs(
    optimiser: Optimiser,
    validation: Loss,
    start: Array,
    limits: Limits,
    folder: Path,
    belongs_to: dict[str, Any],
    report: Report | None,
) -> tuple[Progress, Ending]:
    """What became of training from the weights `start`, and how it ended.

    Resumes from the checkpoint in `folder` that `belongs_to` the same; there is none when it ends, which is
    at the limits or when the optimiser has nothing left to do. `report(epoch, train_loss, validation_loss,
    wall_s)` is called after each epoch. A loss that is not finite ends it as failed, and training of which
    no epoch validates better than its start has failed too, unless it was stopped as hopeless.
    """
    progress = Progress(validation.loss(start), start)
    states = read_checkpoint(folder, belongs_to)
    if states is not None:
        progress = Progress.restored(states["progress"])
        optimiser.restore(states["optimiser"])
    # the clocks of this process, set forward by what an earlier one has spent
    began = time.perf_counter() - progress.wall_s
    processor_began = time.process_time() - progress.processor_s
    saved = time.perf_counter()
    ending: Ending | None = None
    while ending is None and not _at_end(limits, progress, optimiser):
        train_loss = optimiser.epoch()
        validation_loss = validation.loss(optimiser.parameters.astype(np.float64))
        wall_s = time.perf_counter() - began
        processor_s = time.process_time() - processor_began
        progress.add(wall_s, train_loss, validation_loss, optimiser.parameters, processor_s)
        if report is not None:
            report(progress.epoch, train_loss, validation_loss, wall_s)
        if not (math.isfinite(train_loss) and math.isfinite(validation_loss)):
            ending = Ending("failed", f"the loss is not finite after epoch {progress.epoch}")
        else:
            ending = _hopeless(limits, progress)
        if ending is None and time.perf_counter() - saved > CHECKPOINT_EVERY_S:
            write_checkpoint(folder, belongs_to, progress=progress.state(), optimiser=optimiser.state())
            saved = time.perf_counter()
    if ending is None and progress.best_epoch == 0:
        reason = f"none of {progress.epoch} epochs validated better than the weights it began with"
        ending = Ending("failed", reason)
    remove_checkpoint(folder)
    return progress, ending or Ending()


def _hopeless(limits: Limits, progress: Progress) -> Ending | None:
    """The end of a trial that has validated too badly for too long."""
    by = limits.give_up
    if by is None or progress.epoch < by.after_epochs or progress.best_loss <= by.above_nmse:
        return None
    reached = f"the best validation nmse was {progress.best_loss:.3g} after {progress.epoch} epochs"
    return Ending("stopped", f"{reached}, above {by.above_nmse:g}")


def _at_end(limits: Limits, progress: Progress, optimiser: Optimiser) -> bool:
    stalled = limits.patience is not None and progress.stalled_for >= limits.patience
    late = limits.time_limit_s is not None and progress.processor_s >= limits.time_limit_s
    return bool(progress.epoch >= limits.epochs or stalled or late or optimiser.finished)
