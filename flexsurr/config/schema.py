"""What configuration files are built from: strict, frozen records that reject unknown keys; parts of them.

A job is handed a part of its study: the values that it declares to depend on, and no others. Reading a value
that it did not declare raises AttributeError, so that no result depends on a value whose change would not
make it again.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationInfo, field_validator


def by_kind(value: Any) -> Any:
    """The `kind` of a value, by which pydantic chooses among the records that it may be.

    A discriminator that is a field's name would not go with the check of every field below.
    """
    return value.get("kind") if isinstance(value, Mapping) else getattr(value, "kind", None)


class Record(BaseModel):
    """A frozen record. Unknown keys are errors; numbers are finite; integers are not silently floats."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @field_validator("*", mode="before")
    @classmethod
    def _no_truth_values_as_numbers(cls, value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, bool) and cls.model_fields[str(info.field_name)].annotation is not bool:
            raise ValueError(f"{str(value).lower()} is a truth value; allowed: a number or a word")
        return value


def check_once(values: Sequence[Any], what: str = "") -> None:
    """ValueError naming the `values` that come more than once; it begins with `what` they are."""
    if twice := [str(value) for value in dict.fromkeys(values) if values.count(value) > 1]:
        raise ValueError(f"{what}{', '.join(twice)} more than once; allowed: each at most once")


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
        # what is left out where it has its default is in the job by that
        if record_class.model_fields[name].exclude_if is None:
            part.__dict__.pop(name, None)
    return part
