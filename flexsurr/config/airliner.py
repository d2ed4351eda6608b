"""Everything that configuration files say of the airliner, read and checked together."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flexsurr.config.aircraft import Aircraft, load_aircraft
from flexsurr.config.coefficient_sweep import CoefficientSweep, load_coefficient_sweep
from flexsurr.config.errors import ConfigurationError
from flexsurr.config.feature_limits import FeatureLimits, load_feature_limits
from flexsurr.config.flight import FlightSettings, load_flight
from flexsurr.config.schema import Record

STUDY = "airliner"
"""What the airliner is called among the studies: in folders, on the tracking page, in tables."""


class AirlinerFiles(Record):
    """The files of the airliner: how it flies (and which aircraft), over which limits what is learned."""

    flight: str = "config/flight/airliner.yaml"
    limits: str = "config/aircraft/gnba_limits.yaml"
    sweep: str = "config/sweeps/airliner.yaml"


@dataclass(frozen=True)
class Airliner:
    """The airliner's configuration."""

    aircraft: Aircraft
    flight: FlightSettings
    limits: FeatureLimits
    sweep: CoefficientSweep


def load_airliner(root: Path, files: AirlinerFiles) -> Airliner:
    """Read and check `files` below the folder `root`. Raises ConfigurationError with every problem found."""
    problems: list[str] = []

    def read(load: Callable[[Path, str], Any], path: str) -> Any:
        try:
            return load(root / path, path)
        except ConfigurationError as error:
            problems.extend(error.problems)
            return None

    flight = read(load_flight, files.flight)
    limits = read(load_feature_limits, files.limits)
    sweep = read(load_coefficient_sweep, files.sweep)
    aircraft: Any = read(load_aircraft, flight.aircraft) if flight is not None else None
    if problems:
        raise ConfigurationError(problems)
    return Airliner(aircraft, flight, limits, sweep)
