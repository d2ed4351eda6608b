"""Hyperparameter sweeps: spaces of values, as a grid or by draws (config/sweeps/*.yaml)."""

import math
from collections.abc import Iterable, Mapping
from types import GenericAlias
from typing import Annotated, Any, ClassVar, Literal, Self, get_args, get_origin

from pydantic import Discriminator, Field, Tag, create_model, field_validator, model_validator

from flexsurr.config.schema import Record
from flexsurr.config.study import Count
from flexsurr.config.trial import FIELDS, MAPS, Architecture, dimensions

SIGNIFICANT = 6
"""Digits of a number that is drawn: more would name the same trial differently on another machine."""


class Range(Record):
    """The numbers from `low` to `high`, both included; whole ones where the setting counts something.

    In the place of a list of values, where search is random or sobol.
    """

    low: float
    """The least value."""
    high: float
    """The largest value."""
    scale: Literal["linear", "log"] = "linear"
    """linear: equal differences are equally likely; log: equal ratios."""

    whole: ClassVar[bool] = False

    @model_validator(mode="after")
    def _has_numbers(self) -> Self:
        if not self.low < self.high:
            raise ValueError(f"low: {self.low:g} is not allowed; allowed: below high, {self.high:g}")
        if self.scale == "log" and self.low <= 0:
            raise ValueError(f"low: {self.low:g} is not allowed with scale log; allowed: above 0")
        return self

    @property
    def count(self) -> float:
        """How many values there are to draw: infinity where they need not be whole."""
        return int(self.high) - int(self.low) + 1 if self._draws_whole() else math.inf

    def every(self) -> list[Any]:
        """All values; OverflowError where they need not be whole."""
        return [self._value(int(self.low) + step) for step in range(int(self.count))]

    def at(self, share: float) -> Any:
        """The value that lies at `share` of the way, 0 ≤ share < 1."""
        # a whole number has the room from itself to the next
        end = self.high + 1 if self._draws_whole() else self.high
        if self.scale == "log":
            number = self.low * (end / self.low) ** share
        else:
            number = self.low + (end - self.low) * share
        if self._draws_whole():
            return self._value(min(math.floor(number), int(self.high)))
        return self._value(min(max(float(f"{number:.{SIGNIFICANT}g}"), self.low), self.high))

    def _draws_whole(self) -> bool:
        return self.whole

    def _value(self, number: float) -> Any:
        return number


class WholeRange(Range):
    """The same of a setting that counts something."""

    whole = True


class WidthRange(WholeRange):
    """One hidden layer, its number of neurons from a range."""

    def _value(self, number: float) -> Any:
        return (number,)


class OptionRange(Range):
    """A range of one of the `options` of a class of yours: nobody knows whether it counts something."""

    integer: bool = False
    """Whether only whole numbers are drawn."""

    @model_validator(mode="after")
    def _ends_are_whole(self) -> Self:
        if self.integer and not (self.low.is_integer() and self.high.is_integer()):
            raise ValueError(
                f"low, high: {self.low:g}, {self.high:g} are not allowed where integer is true; "
                "allowed: whole numbers"
            )
        return self

    def _draws_whole(self) -> bool:
        return self.integer


class Space(Record):
    """Values to combine; a key with several values, or with a range, is a dimension of the search."""

    architecture: str
    """What is trained: a name below, or a file and a class of yours, as in my_models.py:MyField. Every other
    key of an architecture or optimiser takes a list of values here, or a range where it is a number.
    """

    @field_validator("*", mode="before")
    @classmethod
    def _has_values(cls, value: Any) -> Any:
        if value is None:
            raise ValueError("a key without values; give a list of values, or leave the key out")
        return value

    def dimensions(self) -> dict[tuple[str, ...], tuple[Any, ...] | Range]:
        """The values of each key that is given, or their range; ("options", name) is a keyword's key."""
        found: dict[tuple[str, ...], tuple[Any, ...] | Range] = {}
        for key in type(self).model_fields:
            values = getattr(self, key)
            if key == "options":
                found |= {(key, name): choices for name, choices in (values or {}).items()}
            elif key != "architecture" and values is not None:
                found[(key,)] = values
        return found


class Sweep(Record):
    """A search over one or more spaces: every combination, or `draws` different ones of each space."""

    search: Literal["grid", "random", "sobol"] = "grid"
    """grid: every combination of each space. random: draws by themselves. sobol: those of a scrambled Sobol
    sequence, which fills a space more evenly.
    """
    draws: Count | None = None
    """Different combinations drawn from each space. Given exactly when search is random or sobol."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Seed of these draws."""
    spaces: tuple[Space, ...]
    """Keys with lists of values, or ranges; each space is searched by itself."""

    @model_validator(mode="after")
    def _draws_belong_to_what_draws(self) -> Self:
        if self.search == "grid" and self.draws is not None:
            raise ValueError(
                f"draws: {self.draws} is not allowed with search: grid; allowed: random or sobol"
            )
        if self.search != "grid" and self.draws is None:
            raise ValueError(f"draws: missing with search: {self.search}; allowed: 1 or more")
        return self

    @model_validator(mode="after")
    def _a_grid_has_values(self) -> Self:
        for number, space in enumerate(self.spaces):
            for key, values in space.dimensions().items():
                if self.search == "grid" and isinstance(values, Range):
                    raise ValueError(
                        f"spaces[{number}].{'.'.join(key)}: a range is not allowed where search is grid; "
                        "allowed: a list of values, or search random or sobol"
                    )
        return self


def _sweep(name: str, architectures: Iterable[type[Architecture]]) -> type[Sweep]:
    """Sweeps of trials of `architectures`: spaces take values or a range for each setting that these have."""
    types = dimensions(architectures)
    types.pop("sha256", None)  # a file has it, nobody writes it
    several: dict[str, Any] = {key: (_choice(key, value) | None, None) for key, value in types.items()}
    if "options" in types:  # keywords of a class, each varied by itself
        several["options"] = (GenericAlias(dict, (str, _either(_some(Any), OptionRange))) | None, None)
    several["architecture"] = (types["architecture"], ...)
    space = create_model(f"{name}Space", __base__=Space, **several)
    return create_model(f"{name}Sweep", __base__=Sweep, spaces=(_some(space), ...))


def _some(value: Any) -> Any:
    """The type of one or more values of a type."""
    return Annotated[GenericAlias(tuple, (value, ...)), Field(min_length=1)]


def _choice(key: str, value: Any) -> Any:
    """The type of what a space holds for a setting: values and, if they are numbers, a range of them."""
    plain = value
    while get_origin(plain) is Annotated:
        plain = get_args(plain)[0]
    base: type[Range]
    if key == "hidden":
        end, base = Count, WidthRange
    elif plain in (int, float):
        end, base = value, WholeRange if plain is int else Range
    else:
        return _some(value)
    return _either(_some(value), create_model(base.__name__, __base__=base, low=(end, ...), high=(end, ...)))


def _either(values: Any, form: type[Range]) -> Any:
    """Values, or a range where keys are given; the tags stand in brackets, as no key does."""
    return Annotated[
        Annotated[values, Tag("[values]")] | Annotated[form, Tag("[range]")], Discriminator(_is_range)
    ]


def _is_range(value: Any) -> str:
    return "[range]" if isinstance(value, Mapping | Range) else "[values]"


FieldSweep = _sweep("Field", FIELDS)
"""A search among surrogates of a field ẋ = f(x)."""

MapSweep = _sweep("Map", MAPS)
"""A search among maps y = g(u)."""
