"""A study of samples: maps that stand for the aerodynamics of an aircraft, and its flights with them."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.flight import FlightSettings
from flexsurr.config.panels import PanelCounts
from flexsurr.config.schema import Record
from flexsurr.config.study import DEFAULT, Count


class SampleSettings(Record):
    """How many samples, of which `held_out` are kept to validate on, in how many shards."""

    samples: Count = 4096
    samples_per_shard: Count = 512
    held_out: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.2
    seed: Annotated[int, Field(ge=0)] = 2024
    boundary_condition: Literal["exact", "linear"] = "exact"
    panels: PanelCounts = PanelCounts()

    @property
    def shards(self) -> int:
        """Number of shards; the last may hold fewer samples."""
        return -(-self.samples // self.samples_per_shard)


class SampleStudy(Record):
    """One study. Paths are relative to the folder that holds the Snakefile.

    Samples are drawn from `limits` of the `aircraft`'s vortex lattice, and maps are fitted to them by the
    `sweeps`; the aircraft is flown with each of the best.
    """

    source: Literal["samples"]
    aircraft: str
    limits: str
    sweeps: Annotated[dict[str, str], Field(min_length=1)]
    dataset: SampleSettings = SampleSettings()
    flight: FlightSettings = FlightSettings()

    @model_validator(mode="after")
    def _has_a_default_sweep(self) -> Self:
        if DEFAULT not in self.sweeps:
            raise ValueError(f"sweeps: one of them is called {DEFAULT}")
        return self
