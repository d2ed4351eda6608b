"""Histories of loads as data: the factor that a load follows in time (`history` of a load).

A history of kind table may name a file. `with_table` puts the file's numbers in its place, so that whatever
depends on a load depends on its values.
"""

import csv
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Discriminator, Field, Tag, ValidationError, model_validator

from flexsurr.config.schema import Record, by_kind
from flexsurr.config.structure import NotNegative, Positive


class Interval(Record):
    """A load acts for start_s ≤ t < end_s."""

    start_s: NotNegative = 0.0
    """When the load begins to act [s]."""
    end_s: Positive | None = None
    """When it ends [s], after its start. None: it does not end by itself."""

    @model_validator(mode="after")
    def _ends_after_its_start(self) -> Self:
        if self.end_s is not None and not self.start_s < self.end_s:
            raise ValueError(
                f"end_s: {self.end_s:g} is not allowed; allowed: after start_s: {self.start_s:g}"
            )
        return self


class Constant(Interval):
    """A factor of 1."""

    kind: Literal["constant"] = "constant"
    """Held as it is."""


class Ramp(Interval):
    """A factor that grows evenly from 0 at the start to 1, and stays there."""

    kind: Literal["ramp"] = "ramp"
    """Growing evenly, then held."""
    rise_s: Positive
    """How long it grows [s]."""


class SmoothRamp(Interval):
    """A factor that grows from 0 at the start to 1, and stays there, without a jump of its first two rates.

    τ − sin(2π τ) / 2π with τ = (t − start_s) / rise_s: the spin-up of Simo and Vu-Quoc (1986).
    """

    kind: Literal["smooth_ramp"] = "smooth_ramp"
    """Growing smoothly, then held."""
    rise_s: Positive
    """How long it grows [s]."""


class Sine(Interval):
    """The factor sin(ω t + phase)."""

    kind: Literal["sine"] = "sine"
    """Swinging."""
    frequency_rad_s: Positive
    """ω, the angular frequency [rad/s]."""
    phase_rad: float = 0.0
    """The phase at t = 0 [rad]."""


class OneMinusCosine(Interval):
    """One bump, as of a discrete gust: the factor ½ (1 − cos(2π (t − start_s) / duration_s)), then 0."""

    kind: Literal["one_minus_cosine"] = "one_minus_cosine"
    """Rising to 1 and back, once."""
    duration_s: Positive
    """From the start to the end of the bump [s]; its factor is 1 half-way."""


class Power(Interval):
    """A power of the time as factor: (t / reference_s)^exponent."""

    kind: Literal["power"] = "power"
    """Growing from t = 0."""
    exponent: Annotated[int, Field(ge=1)]
    """Power of (t / reference_s)."""
    reference_s: Positive = 1.0
    """The time at which the factor is 1 [s]."""


class Table(Interval):
    """Factors at given times, with straight lines between them; 0 before the first and from the last on."""

    kind: Literal["table"] = "table"
    """As a file has it, or two lists."""
    file: str | None = None
    """A CSV with a header and two columns, t_s and factor: such as data/gust.csv, below the folder that
    holds the Snakefile. None: times_s and factors are given here.
    """
    times_s: tuple[float, ...] = ()
    """Increasing times [s], two or more."""
    factors: tuple[float, ...] = ()
    """The factor at each of them."""

    @model_validator(mode="after")
    def _is_a_table(self) -> Self:
        if (self.file is None) == (not self.times_s):
            raise ValueError("file, times_s: one of the two is needed; allowed: a file, or times and factors")
        if len(self.times_s) != len(self.factors):
            raise ValueError(
                f"factors: {len(self.factors)} for {len(self.times_s)} times; allowed: one for each"
            )
        if self.file is None and len(self.times_s) < 2:
            raise ValueError("times_s: one time alone is no table; allowed: two or more")
        for before, after in pairwise(self.times_s):
            if not before < after:
                raise ValueError(
                    f"times_s: {after:g} after {before:g} is not allowed; allowed: increasing times"
                )
        return self


# Another history is one more record here, and its factor, slope and integral in flexsurr.simulation.history.
History = Annotated[
    Annotated[Constant, Tag("constant")]
    | Annotated[Ramp, Tag("ramp")]
    | Annotated[SmoothRamp, Tag("smooth_ramp")]
    | Annotated[Sine, Tag("sine")]
    | Annotated[OneMinusCosine, Tag("one_minus_cosine")]
    | Annotated[Power, Tag("power")]
    | Annotated[Table, Tag("table")],
    Discriminator(by_kind),
]

COLUMNS = ("t_s", "factor")


def with_table(history: History, root: Path) -> History:
    """The same history with the numbers of the file that it names, if any, below the folder `root`.

    ValueError, on one line, for a file that is not there or is no such table.
    """
    if not isinstance(history, Table) or history.file is None:
        return history
    name = history.file
    try:
        with (root / name).open(newline="", encoding="utf-8-sig") as lines:
            header, *rows = [row for row in csv.reader(lines) if row] or [[]]
    except (OSError, UnicodeDecodeError, csv.Error):
        raise ValueError(f"history.file: {name!r} cannot be read; allowed: a CSV file") from None
    if tuple(word.strip() for word in header) != COLUMNS:
        raise ValueError(f"{name}: its header is {','.join(header)!r}; allowed: {','.join(COLUMNS)}")
    values = []
    for number, row in enumerate(rows, start=2):
        try:
            time_s, factor = map(float, row)
        except ValueError:
            raise ValueError(f"{name}: row {number} is {','.join(row)!r}; allowed: two numbers") from None
        values.append((time_s, factor))
    if len(values) < 2:
        raise ValueError(f"{name}: {len(values)} rows are no table; allowed: two or more")
    times_s, factors = zip(*values, strict=True)
    given = {"start_s": history.start_s, "end_s": history.end_s}
    try:
        return Table(times_s=times_s, factors=factors, **given)
    except ValidationError as error:
        problem = error.errors()[0]["msg"].removeprefix("Value error, ")
        raise ValueError(f"{name}: {problem}") from None
