"""What a fit has come to: its losses by epoch, and the best weights since its start."""

from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from flexsurr.simulation.rhs import Array

WORTH_WAITING_FOR = 0.01
COLUMNS = ("epoch", "wall_s", "train_loss", "validation_loss", "processor_s")


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
