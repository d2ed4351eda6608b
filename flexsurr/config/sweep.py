"""Hyperparameter sweeps: spaces of values, searched as a grid or by random draws (config/sweeps/*.yaml)."""

from collections.abc import Iterable
from types import GenericAlias
from typing import Annotated, Any, Literal, Self

from pydantic import Field, create_model, field_validator, model_validator

from flexsurr.config.schema import Record
from flexsurr.config.study import Count
from flexsurr.config.trial import FIELDS, MAPS, Architecture, dimensions


class Space(Record):
    """Values to combine; a key with several values is a dimension of the search."""

    architecture: str
    """What is trained: a name below, or a file and a class of yours, as in my_models.py:MyField. Every other
    key of an architecture or optimiser takes a list of values here.
    """

    @field_validator("*", mode="before")
    @classmethod
    def _has_values(cls, value: Any) -> Any:
        if value is None:
            raise ValueError("a key without values; give a list of values, or leave the key out")
        return value


class Sweep(Record):
    """A search over one or more spaces: every combination, or `draws` random ones of each space."""

    search: Literal["grid", "random"] = "grid"
    """grid takes every combination of each space, random some."""
    draws: Count | None = None
    """Combinations that are drawn from each space. Given exactly when search is random."""
    seed: int = 0
    """Seed of these draws."""
    spaces: tuple[Space, ...]
    """Keys with lists of values; each space is searched by itself."""

    @model_validator(mode="after")
    def _draws_belong_to_random(self) -> Self:
        if (self.search == "random") != (self.draws is not None):
            raise ValueError("draws is given exactly when search is random")
        return self


def _sweep(name: str, architectures: Iterable[type[Architecture]]) -> type[Sweep]:
    """Sweeps of trials of `architectures`: spaces take a list of values for each setting that these have."""
    types = dimensions(architectures)
    types.pop("sha256", None)  # a file has it, nobody writes it
    several: dict[str, Any] = {key: (_some(value) | None, None) for key, value in types.items()}
    if "options" in types:  # keywords of a class, each varied by itself
        several["options"] = (GenericAlias(dict, (str, _some(Any))) | None, None)
    several["architecture"] = (types["architecture"], ...)
    space = create_model(f"{name}Space", __base__=Space, **several)
    return create_model(f"{name}Sweep", __base__=Sweep, spaces=(_some(space), ...))


def _some(value: Any) -> Any:
    """The type of one or more values of a type."""
    return Annotated[GenericAlias(tuple, (value, ...)), Field(min_length=1)]


FieldSweep = _sweep("Field", FIELDS)
"""A search among surrogates of a field ẋ = f(x)."""

MapSweep = _sweep("Map", MAPS)
"""A search among maps y = g(u)."""
