"""Configuration errors a person can act on: one line a problem, with file, key, value and what is allowed."""

import difflib
import json
import types
from collections.abc import Callable, Iterable, Sequence
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

Location = tuple[str | int, ...]
LONGEST_VALUE = 80


class ConfigurationError(Exception):
    """What is wrong with a configuration; `problems` holds one line each."""

    def __init__(self, problems: Iterable[str]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(self.problems))


def describe(
    error: ValidationError, record: type[BaseModel], origin: Callable[[Location], tuple[str, str]]
) -> list[str]:
    """One line for each problem of a failed validation of `record`.

    `origin` tells for the location of a value the file it came from and its key in that file.
    """
    return [
        _line(details, record, origin)
        for details in error.errors(include_url=False)
        # A list whose only values are wrong also counts as too short.
        if not (details["type"] == "too_short" and details["input"])
    ]


def nearest(word: str, known: Sequence[str]) -> str:
    """A hint at the known word most like `word`, or nothing."""
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.6)
    return f"; did you mean {close[0]!r}?" if close else ""


def key_path(location: Location) -> str:
    """A location as a person writes it: spaces[0].activation."""
    text = ""
    for step in location:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else step
    return text


def _line(
    details: ErrorDetails, record: type[BaseModel], origin: Callable[[Location], tuple[str, str]]
) -> str:
    # what stands in brackets is no key: a mapping's key itself, or the tag of a union
    tagged = tuple(step for step in details["loc"] if not str(step).startswith("["))
    location, _ = _resolve(record, tagged)
    file, key = origin(location)
    value = details["input"]
    where = f"{file}: {key}" if key else file
    match details["type"]:
        case "extra_forbidden":
            fields = tuple(_resolve(record, tagged[:-1])[1].model_fields)
            return (
                f"{where}: unknown key (value {_short(value)}){nearest(str(location[-1]), fields)}; "
                f"allowed: {', '.join(fields)}"
            )
        case "missing":
            return f"{where}: missing; a value is needed"
        case "value_error":
            # A rule between the keys of a record: its own words name them.
            return f"{where}: {details['msg'].removeprefix('Value error, ')}{_shown(value)}"
        case "literal_error":
            expected = str(details["ctx"]["expected"])
            known = [word.strip("' ") for part in expected.split(",") for word in part.split(" or ")]
            return f"{where}: {_short(value)} is not allowed{nearest(str(value), known)}; allowed: {expected}"
        case "union_tag_invalid":
            tags = details["ctx"]
            return f"{where}.kind: {tags['tag']!r} is not allowed; allowed: {tags['expected_tags']}"
        case "union_tag_not_found" if isinstance(value, dict):
            return f"{where}.kind: missing; a value is needed"
        case "too_short":
            return f"{where}: {_short(value)} is empty; allowed: at least one value"
        case "too_long":
            allowed = f"at most {details['ctx']['max_length']} values"
        case kind:
            # what follows a comma tells how pydantic has tried to read it
            words = details["msg"].removeprefix("Input should be ").removeprefix("a valid ").split(",")[0]
            allowed = ALLOWED.get(kind, words)
    return f"{where}: {_short(value)} is not allowed; allowed: {allowed}"


ALLOWED = {
    "tuple_type": "a list of values in brackets",
    "list_type": "a list of values in brackets",
    "model_type": "keys with values",
    "model_attributes_type": "keys with values",
    "dict_type": "keys with values",
    "union_tag_not_found": "keys with values",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_type": "text",
    "string_too_short": "at least one character",
}
"""Where pydantic's own words would be foreign: what is allowed, by the type of its error."""


def _short(value: Any) -> str:
    """A value as a person writes it; the beginning of a long one."""
    text = json.dumps(value) if value is None or isinstance(value, bool) else repr(value)
    return text if len(text) <= LONGEST_VALUE else text[:LONGEST_VALUE] + "…"


def _shown(value: Any) -> str:
    return "" if isinstance(value, dict) and len(repr(value)) > LONGEST_VALUE else f" (value {_short(value)})"


def _resolve(record: type[BaseModel], location: Location) -> tuple[Location, type[BaseModel]]:
    """`location` without the tags of unions, which are no keys, and the record that stands there."""
    plain: list[str | int] = []
    members: dict[str, type[BaseModel]] = {}
    for step in location:
        if step in members:
            record, members = members[str(step)], {}
            continue
        plain.append(step)
        if isinstance(step, str) and step in record.model_fields:
            nested = _records_in(record.model_fields[step].annotation)
            members = {_kind(member): member for member in nested} if len(nested) > 1 else {}
            record = nested[0] if nested else record
    return tuple(plain), record


def _kind(record: type[BaseModel]) -> str:
    return str(get_args(record.model_fields["kind"].annotation)[0])


def _records_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if get_origin(annotation) is Annotated:
        return _records_in(get_args(annotation)[0])
    if get_origin(annotation) is None and not isinstance(annotation, types.UnionType | type(Union)):
        return []
    return [found for part in get_args(annotation) for found in _records_in(part)]
