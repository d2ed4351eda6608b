"""Values laid over one another from several files, remembering which file each came from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from flexsurr.config.errors import ConfigurationError, Location, describe, key_path

RecordT = TypeVar("RecordT", bound=BaseModel)


@dataclass(frozen=True)
class Source:
    """Values from one file, and where in that file they stand."""

    file: str
    values: Mapping[str, Any]
    below: Location = ()


def merge(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """`base` with the values of `over` laid on top, mapping by mapping; lists are replaced whole."""
    merged = dict(base)
    for key, value in over.items():
        old = merged.get(key)
        merged[key] = merge(old, value) if isinstance(old, Mapping) and isinstance(value, Mapping) else value
    return merged


def build(record: type[RecordT], sources: Sequence[Source]) -> RecordT:
    """The record from the values of `sources`, later ones on top.

    Raises ConfigurationError, each problem with the file that its value came from.
    """
    values: dict[str, Any] = {}
    for source in sources:
        values = merge(values, source.values)

    def origin(location: Location) -> tuple[str, str]:
        # The last source in which the value, or else the nearest key above it, can be found.
        for depth in range(len(location), 0, -1):
            for source in reversed(sources):
                if _holds(source.values, location[:depth]):
                    return source.file, key_path(source.below + location)
        return sources[0].file, key_path(sources[0].below + location)

    try:
        return record.model_validate(values)
    except ValidationError as error:
        raise ConfigurationError(describe(error, record, origin)) from None


def _holds(values: Any, location: Location) -> bool:
    for step in location:
        inside = step < len(values) if isinstance(values, list) and isinstance(step, int) else False
        if not inside and not (isinstance(values, Mapping) and step in values):
            return False
        values = values[step]
    return True
