"""What training comes to, of a field or of a map."""

from dataclasses import dataclass
from typing import Any

import pandas as pd

from flexsurr.training.epochs import Status


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
