"""YAML files of keys and values, read with errors that name file and line, and laid over one another.

Of every value it is remembered which file it came from.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError

from flexsurr.config.errors import ConfigurationError, Location, describe, key_path


def _refused(problem: str, node: yaml.Node) -> yaml.constructor.ConstructorError:
    return yaml.constructor.ConstructorError(problem=problem, problem_mark=node.start_mark)


class _Strict(yaml.CSafeLoader):
    """YAML's safe loader in C, except that what it would read otherwise than it looks is an error.

    That is a key given twice, of which the last would hold; one that is no text, such as 1 or on; a date; and
    a number with a leading zero or a colon, which would be of base 8 or 60.
    """

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """The mapping of `node`; raises ConstructorError for a key that comes twice or is no text."""
        seen = set()
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                continue
            key = key_node.value
            if not isinstance(self.construct_object(key_node), str):
                raise _refused(f"key {key!r} is no text; allowed: in quotes", key_node)
            if key in seen:
                raise _refused(f"key {key!r} is given twice", key_node)
            seen.add(key)
        return super().construct_mapping(node, deep)


def _decimal(loader: _Strict, node: yaml.ScalarNode) -> int | float:
    whole = node.value.partition(".")[0]
    if ":" in whole or re.match(r"[-+]?0[0-9_]", whole):
        raise _refused(f"{node.value} is no decimal number", node)
    kind = node.tag.rpartition(":")[2]
    number: int | float = getattr(loader, f"construct_yaml_{kind}")(node)
    return number


def _date(loader: _Strict, node: yaml.ScalarNode) -> str:
    raise _refused(f"{node.value} is a date; allowed: in quotes", node)


for kind in ("int", "float"):
    _Strict.add_constructor(f"tag:yaml.org,2002:{kind}", _decimal)
_Strict.add_constructor("tag:yaml.org,2002:timestamp", _date)


def read_yaml(path: Path, shown: str | None = None) -> dict[str, Any]:
    """The keys and values of the YAML file at `path`, named `shown` in errors.

    Raises ConfigurationError if the file is missing or cannot be read, is not YAML, or holds something else
    than keys with values.
    """
    name = shown or str(path)
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ConfigurationError([f"{name}: no such file (looked for {path.absolute()})"]) from None
    except IsADirectoryError:
        raise ConfigurationError([f"{name}: is a folder; a YAML file is needed"]) from None
    except UnicodeDecodeError as error:
        raise ConfigurationError([f"{name}: is not text in UTF-8 (byte {error.start})"]) from None
    except OSError as error:
        raise ConfigurationError([f"{name}: cannot be read: {error.strerror}"]) from None
    try:
        # The loader is SafeLoader with one more check.
        content = yaml.load(text, Loader=_Strict)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        line = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        what = " ".join(part for part in (error.context, error.problem) if part)
        raise ConfigurationError([f"{name}{line}: is not YAML: {what}"]) from None
    except (yaml.YAMLError, ValueError) as error:
        raise ConfigurationError([f"{name}: is not YAML: {' '.join(str(error).split())}"]) from None
    if content is None:
        raise ConfigurationError([f"{name}: is empty; allowed: keys with values"])
    if not isinstance(content, dict):
        raise ConfigurationError([f"{name}: holds {content!r:.60}; allowed: keys with values"])
    return content


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
