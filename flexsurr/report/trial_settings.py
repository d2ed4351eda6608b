"""By which settings the trials of a study differ: what a person reads of a sweep."""

import re
from typing import Any

import pandas as pd

from flexsurr.config.trial import FIELDS, MAPS, dimensions

UNSEEN = ("sha256", "device")
"""What no two trials of a sweep are compared by."""

HOW_LONG = (
    "seed",
    "batch_size",
    "weight_decay",
    "precision",
    "loss",
    "keep",
    "epochs",
    "patience",
    "time_limit_s",
    "give_up",
)
"""Settings that are told only where the same network, by the same optimiser, has several."""

OF_A_NETWORK = ["architecture", "optimiser", "hidden", "degree"]

FEW = 6
"""So many numbers are choices; more are a range."""


def settings_that_differ(metrics: pd.DataFrame) -> pd.DataFrame:
    """A row for each run of `metrics` and a column for each setting that tells them apart.

    That of the architecture comes first, and what goes with it alone is left out. Values are numbers, or
    words; NaN where a run takes none. A keyword of a class of the user's own has a column of its own.
    """
    known = list(dict.fromkeys(name for kind in (FIELDS, MAPS) for name in dimensions(kind)))
    ordered = [name for name in known if name not in (*UNSEEN, *HOW_LONG, "options")]
    ordered = [*ordered, "dataset", *HOW_LONG]
    written = metrics.rename(columns={"epochs": "epochs_done", "epoch_limit": "epochs"})
    frame = written.reindex(columns=ordered).join(_keywords(metrics))
    frame = frame.apply(_plain)
    network = [name for name in OF_A_NETWORK if frame[name].nunique(dropna=False) <= FEW]
    follows = {
        name: follow_from(frame, ["architecture", *(network if name in HOW_LONG else [])], name)
        for name in map(str, frame)
    }
    return frame[["architecture", *(name for name, is_told in follows.items() if not is_told)]]


def follow_from(frame: pd.DataFrame, known: list[str], name: str) -> bool:
    """Whether who knows these columns of a row knows what it has in the column `name`."""
    by = list(dict.fromkeys(known))
    return name in by or bool((frame.groupby(by, dropna=False)[name].nunique(dropna=False) <= 1).all())


def in_words(settings: pd.Series) -> str:
    """The settings of one run, without those it does not take: hidden 16, activation atan."""
    return ", ".join(
        f"{str(name).replace('_', ' ')} {as_text(value)}"
        for name, value in settings.items()
        if pd.notna(value)
    )


def as_text(value: object) -> str:
    """A value of a setting as a person writes it; a network of the user's own goes by its class."""
    return f"{value:g}" if isinstance(value, float | int) else str(value).rpartition(":")[2]


def _keywords(metrics: pd.DataFrame) -> pd.DataFrame:
    """The keywords of classes of the user's own, which a run holds as text: width=8, gain=0.5."""
    texts = metrics["options"] if "options" in metrics else pd.Series(None, index=metrics.index)
    rows = [
        dict(pair.split("=", 1) for pair in re.split(r", (?=\w+=)", text)) if isinstance(text, str) else {}
        for text in texts
    ]
    return pd.DataFrame(rows, index=metrics.index).add_prefix("option ")


def _plain(values: "pd.Series[Any]") -> "pd.Series[Any]":
    """Numbers, where all are; words otherwise, nothing for those that are empty."""
    given = values.map(lambda value: None if value == "" else value)
    numbers = pd.to_numeric(given, errors="coerce")
    return numbers if numbers.notna().equals(given.notna()) else given
