"""Parts of a record: the values a job declares that it depends on, and no others.

A job is handed a part of its study. Reading a value that it did not declare raises AttributeError, so
that no result depends on a value whose change would not make it again.
"""

from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, TypeAdapter

RecordT = TypeVar("RecordT", bound=BaseModel)


def values_of(record: BaseModel, keys: Iterable[str]) -> dict[str, Any]:
    """The JSON-able values of `keys`, which may be dotted (`dataset.step_s`), nested as in the record."""
    nested: dict[str, Any] = {}
    for key in keys:
        head, _, rest = key.partition(".")
        value = getattr(record, head)
        if rest:
            nested.setdefault(head, {}).update(values_of(value, [rest]))
        elif isinstance(value, BaseModel):
            nested[head] = value.model_dump(mode="json")
        else:
            # Through the field's own type, so that tuples of records come out as plain data too.
            nested[head] = record.model_dump(mode="json", include={head})[head]
    return nested


def part_of(record_class: type[RecordT], values: Mapping[str, Any]) -> RecordT:
    """The record with `values` alone; every other attribute, defaults included, is an AttributeError.

    Raises ValidationError or KeyError for what `values_of` cannot have written.
    """
    fields: dict[str, Any] = {}
    for name, value in values.items():
        annotation: Any = record_class.model_fields[name].annotation
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            fields[name] = part_of(annotation, value)
        else:
            fields[name] = TypeAdapter(annotation).validate_python(value)
    part = record_class.model_construct(**fields)
    for name in record_class.model_fields.keys() - values.keys():
        part.__dict__.pop(name, None)
    return part
