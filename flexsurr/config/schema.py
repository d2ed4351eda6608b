"""What every configuration file is built from: strict, frozen records that reject unknown keys."""

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationInfo, field_validator


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
