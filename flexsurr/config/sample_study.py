"""A study of samples: maps that stand for the aerodynamics of an aircraft, and its flights with them."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.aerodynamics import PanelCounts
from flexsurr.config.flight import FlightSettings
from flexsurr.config.schema import Record
from flexsurr.config.structure import Positive
from flexsurr.config.study import DEFAULT, Count


class SampleSettings(Record):
    """The samples, in shards."""

    samples: Count = 4096
    """Samples in all."""
    samples_per_shard: Count = 512
    """Samples in a file; each file is a job."""
    held_out: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.2
    """Share that validates."""
    seed: Annotated[int, Field(ge=0)] = 2024
    """Seed of the draws."""
    boundary_condition: Literal["exact", "linear"] = "exact"
    """Of the lattice. exact: products of inputs are kept; linear: first order in every input, of which the
    quadratic form is exact.
    """
    panels: PanelCounts = PanelCounts()
    """How finely the lattice is cut."""

    @model_validator(mode="after")
    def _some_train_and_some_validate(self) -> Self:
        validate = round(self.held_out * self.samples)
        if not 1 <= validate <= self.samples - 2:  # of one sample no output varies
            raise ValueError(
                f"samples: {self.samples} is not allowed with held_out: {self.held_out:g}, which leaves "
                f"{self.samples - validate} to train on and {validate} to validate; allowed: 2 and 1, or more"
            )
        return self

    @property
    def shards(self) -> int:
        """Number of shards; the last may hold fewer samples."""
        return -(-self.samples // self.samples_per_shard)


class MapSelection(Record):
    """The rule by which a map is chosen among the runs of a kind."""

    nmse_at_most: Positive | None = None
    """Of the runs whose validation nmse is at most so much, the one is chosen that takes the fewest
    operations. None, or where no run errs so little: the most accurate.
    """


class SampleStudy(Record):
    """A study of an aircraft: samples of its vortex lattice train maps, and it is flown with the best."""

    source: Literal["samples"]
    """Where its data come from: samples of a vortex lattice."""
    aircraft: str
    """The file of the aircraft."""
    limits: str
    """The file of the intervals that samples are drawn from."""
    sweeps: Annotated[dict[str, str], Field(min_length=1)]
    """The files of its sweeps by names of yours. One is called default: figures show it, and one of its
    spaces is a network, to fly with.
    """
    dataset: SampleSettings = SampleSettings()
    """Its samples."""
    selection: MapSelection = MapSelection()
    """Which maps are chosen."""
    flight: FlightSettings = FlightSettings()
    """How the aircraft is flown."""

    @model_validator(mode="after")
    def _has_a_default_sweep(self) -> Self:
        if DEFAULT not in self.sweeps:
            raise ValueError(f"sweeps: {', '.join(self.sweeps)}; allowed: one of them is called {DEFAULT}")
        return self
