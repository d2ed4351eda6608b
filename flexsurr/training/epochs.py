"""Epoch after epoch, whatever is fitted: validated, timed, reported, kept from a kill, and ended."""

import json
import math
import time
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, Protocol

import numpy as np
import pandas as pd

from flexsurr.config.trial import GiveUp, Iterative
from flexsurr.simulation.rhs import Array
from flexsurr.storage import replacing

WORTH_WAITING_FOR = 0.01
COLUMNS = ("epoch", "wall_s", "train_loss", "validation_loss", "processor_s")
CHECKPOINT = "checkpoint.npz"
CHECKPOINT_EVERY_S = 5.0

Report = Callable[[int, float, float, float], None]
Status = Literal["finished", "stopped", "failed"]


class Optimiser(Protocol):
    """Advances `parameters` (n,) by an epoch at a time."""

    @property
    def parameters(self) -> Array:
        """The weights."""
        ...

    finished: str
    """Why there is nothing left to do; empty while there is."""

    def epoch(self) -> float:
        """Advance by one epoch; the training loss, not finite if the weights have left the numbers."""
        ...

    def state(self) -> dict[str, Array]:
        """Everything that the next epoch depends on, as arrays."""
        ...

    def restore(self, state: dict[str, Array]) -> None:
        """Go on from a `state`, to the same weights as without the interruption."""
        ...


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


@dataclass(frozen=True, eq=False)
class Fit:
    """What a trial came to: the surrogate that the trial keeps, and the one that validated best.

    `final_loss` is the last epoch's, as trained; all others are the nmse. A fit that did not finish holds
    the best weights it met: at epoch 0, the random ones it began with. Of a map the states are its outputs.
    """

    surrogate: Any
    best: Any
    status: Status
    reason: str
    epochs: int
    best_epoch: int
    wall_s: float
    processor_s: float
    final_loss: float
    train_nmse: float
    validation_nmse: float
    best_validation_nmse: float
    parameters: int
    history: pd.DataFrame
    validation_nmse_per_state: tuple[float, ...]


@dataclass
class Progress:
    """Rows of COLUMNS, and the weights with the least validation loss; those of epoch 0 at first.

    The mark is the last validation loss that was lower by `WORTH_WAITING_FOR` than the mark before it.
    """

    best_loss: float
    best_parameters: Array
    best_epoch: int = 0
    mark_loss: float = np.inf
    mark_epoch: int = 0
    rows: list[tuple[float, ...]] = field(default_factory=list)

    @property
    def epoch(self) -> int:
        """Number of epochs done."""
        return len(self.rows)

    @property
    def stalled_for(self) -> int:
        """Number of epochs since validation has last improved by an amount worth waiting for."""
        return self.epoch - self.mark_epoch

    @property
    def wall_s(self) -> float:
        """Seconds spent on them, interruptions not counted."""
        return self.rows[-1][1] if self.rows else 0.0

    @property
    def processor_s(self) -> float:
        """Processor time of the same [s]: what other work on the machine does not change."""
        return self.rows[-1][4] if self.rows else 0.0

    @property
    def final_loss(self) -> float:
        """The training loss of the last epoch, as trained; NaN before the first."""
        return self.rows[-1][2] if self.rows else np.nan

    def add(
        self,
        wall_s: float,
        train_loss: float,
        validation_loss: float,
        parameters: Array,
        processor_s: float,
    ) -> None:
        """Note the next epoch, and its weights if none validated as well before."""
        self.rows.append((self.epoch + 1.0, wall_s, train_loss, validation_loss, processor_s))
        if validation_loss < self.best_loss:
            self.best_epoch, self.best_loss = self.epoch, validation_loss
            self.best_parameters = parameters.astype(np.float64)
        if validation_loss < (1.0 - WORTH_WAITING_FOR) * self.mark_loss:
            self.mark_epoch, self.mark_loss = self.epoch, validation_loss

    def history(self) -> pd.DataFrame:
        """A row an epoch: epoch, wall_s, train_loss, validation_loss (nmse), processor_s."""
        frame = pd.DataFrame(np.array(self.rows).reshape(-1, len(COLUMNS)), columns=list(COLUMNS))
        return frame.astype({"epoch": np.int64})

    def figures(self) -> dict[str, Any]:
        """What it says in a `Fit`, by the names there."""
        return {
            "epochs": self.epoch,
            "best_epoch": self.best_epoch,
            "wall_s": self.wall_s,
            "processor_s": self.processor_s,
            "final_loss": self.final_loss,
            "history": self.history(),
        }

    def state(self) -> dict[str, Array]:
        """Everything above, as arrays."""
        return {
            "rows": np.array(self.rows).reshape(-1, len(COLUMNS)),
            "best_epoch": np.array(self.best_epoch),
            "best_loss": np.array(self.best_loss),
            "mark_epoch": np.array(self.mark_epoch),
            "mark_loss": np.array(self.mark_loss),
            "best_parameters": self.best_parameters,
        }

    @classmethod
    def at_once(
        cls,
        wall_s: float,
        losses: tuple[float, float],
        parameters: Array,
        processor_s: float,
        report: Report | None,
    ) -> "Progress":
        """That of a linear fit: one epoch, with its `losses` in training and validation, reported."""
        progress = cls(math.inf, parameters)
        progress.add(wall_s, *losses, parameters, processor_s)
        if report is not None:
            report(1, *losses, wall_s)
        return progress

    @classmethod
    def restored(cls, state: dict[str, Array]) -> "Progress":
        """From a `state`."""
        return cls(
            best_loss=float(state["best_loss"]),
            best_parameters=state["best_parameters"],
            best_epoch=int(state["best_epoch"]),
            mark_loss=float(state["mark_loss"]),
            mark_epoch=int(state["mark_epoch"]),
            rows=[tuple(row) for row in state["rows"].tolist()],
        )


def write_checkpoint(folder: Path, belongs_to: Mapping[str, Any], **states: dict[str, Array]) -> None:
    """Write the arrays of the named `states` whole, with what they belong to (plain JSON values)."""
    arrays = {f"{name}/{key}": array for name, state in states.items() for key, array in state.items()}
    with replacing(folder / CHECKPOINT) as beside, beside.open("wb") as file:
        np.savez(file, allow_pickle=False, belongs_to=np.array(_canonical(belongs_to)), **arrays)


def read_checkpoint(folder: Path, belongs_to: Mapping[str, Any]) -> dict[str, dict[str, Array]] | None:
    """The states in `folder` by name; None if there are none, or damaged ones, or those of another fit."""
    try:
        with (folder / CHECKPOINT).open("rb") as content, np.load(content, allow_pickle=False) as file:
            arrays = dict(file)
    except (OSError, EOFError, ValueError, TypeError, RuntimeError, zipfile.BadZipFile):
        return None
    if str(arrays.pop("belongs_to", "")) != _canonical(belongs_to):
        return None
    states: dict[str, dict[str, Array]] = {}
    for place, array in arrays.items():
        name, key = place.split("/")
        states.setdefault(name, {})[key] = array
    return states


def remove_checkpoint(folder: Path) -> None:
    """Remove the checkpoint in `folder`, if there is one."""
    (folder / CHECKPOINT).unlink(missing_ok=True)


def _canonical(values: Mapping[str, Any]) -> str:
    return json.dumps(dict(values), sort_keys=True)


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


@dataclass(frozen=True, eq=False)
class Trained:
    """What came of training: the weights that the trial keeps, those that validated best, and how it went."""

    kept: Array
    best: Array
    progress: Progress
    ending: Ending


def train(
    trial: Iterative,
    optimiser: Optimiser,
    validation: Loss,
    start: Array,
    folder: Path,
    belongs_to: dict[str, Any],
    report: Report | None,
    prepared: tuple[float, float] = (0.0, 0.0),
) -> Trained:
    """Train from the weights `start` to the trial's limits: `run_epochs` of this trial."""
    progress, ending = run_epochs(
        optimiser,
        validation,
        start,
        Limits.of(trial),
        folder,
        {"trial": trial.model_dump(mode="json"), **belongs_to},
        report,
        prepared,
    )
    best = progress.best_parameters
    keeps_best = ending.reason or trial.keep == "best"
    kept = best if keeps_best else optimiser.parameters.astype(np.float64)
    return Trained(kept, best, progress, ending)


def run_epochs(
    optimiser: Optimiser,
    validation: Loss,
    start: Array,
    limits: Limits,
    folder: Path | None = None,
    belongs_to: Mapping[str, Any] = MappingProxyType({}),
    report: Report | None = None,
    prepared: tuple[float, float] = (0.0, 0.0),
) -> tuple[Progress, Ending]:
    """What became of training from the weights `start`, and how it ended.

    `prepared` are the seconds of wall and processor that these weights took, the first that count.

    Resumes from the checkpoint in `folder`, if one is given, that `belongs_to` the same; there is none when
    it ends, which is at the limits or when the optimiser has nothing left to do. `report(epoch, train_loss,
    validation_loss, wall_s)` is called after each epoch. A loss that is not finite ends it as failed, and
    training of which no epoch validates better than its start has failed too, unless it was stopped as
    hopeless.
    """
    progress = Progress(validation.loss(start), start)
    states = read_checkpoint(folder, belongs_to) if folder else None
    if states is not None:
        progress = Progress.restored(states["progress"])
        optimiser.restore(states["optimiser"])
    # the clocks of this process, set forward by what has been spent
    spent = prepared if states is None else (progress.wall_s, progress.processor_s)
    began, processor_began = time.perf_counter() - spent[0], time.process_time() - spent[1]
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
        if folder and ending is None and time.perf_counter() - saved > CHECKPOINT_EVERY_S:
            write_checkpoint(folder, belongs_to, progress=progress.state(), optimiser=optimiser.state())
            saved = time.perf_counter()
    if ending is None and progress.best_epoch == 0:
        reason = f"none of {progress.epoch} epochs validated better than the weights it began with"
        ending = Ending("failed", reason)
    if folder:
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
