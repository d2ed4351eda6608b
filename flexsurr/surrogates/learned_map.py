"""What a learned map y = g(u) is: no right-hand side but a part of one.

It stands for the aerodynamics of an airliner (25 features, 12 coefficients), or for a load's generalised
forces at the coordinates of a beam. The Jacobian of learned positions gives such forces, Q = (∂r̂/∂η)ᵀ F,
which do the work of F along them exactly.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Protocol

import numpy as np

from flexsurr.simulation.mapping import CompiledMapping
from flexsurr.simulation.rhs import Array


@dataclass(frozen=True, eq=False)
class Intervals:
    """Quantities by name, each with the interval from `low` to `high` (n,) that a map sees as −1 to 1.

    Raises ValueError for intervals that are none, or not one for each name.
    """

    names: tuple[str, ...]
    low: Array
    high: Array

    def __post_init__(self) -> None:
        shape = (len(self.names),)
        if self.low.shape != shape or self.high.shape != shape or not np.all(self.low < self.high):
            raise ValueError(f"each of {', '.join(self.names)} has an interval, and low < high")

    @cached_property
    def origin(self) -> Array:
        """The middle (n,) of each."""
        return 0.5 * (self.low + self.high)

    @cached_property
    def half(self) -> Array:
        """Half the length (n,) of each."""
        return 0.5 * (self.high - self.low)

    def scaled(self, values: Array) -> Array:
        """`values` (..., n), those within the intervals between −1 and 1."""
        return (values - self.origin) / self.half

    def only(self, names: Sequence[str]) -> "Intervals":
        """Some of them, in the order of `names`."""
        places = [self.names.index(name) for name in names]
        return Intervals(tuple(names), self.low[places], self.high[places])


class LearnedMap(Protocol):
    """What every map is, whatever it is made of."""

    kind: ClassVar[str]

    @property
    def inputs(self) -> Intervals:
        """The inputs, between the values that it was fitted to."""
        ...

    @property
    def output_names(self) -> tuple[str, ...]:
        """Names of the outputs, in their order."""
        ...

    def __call__(self, u: Array) -> Array:
        """Outputs at inputs, (..., n) -> (..., k), both in their units."""
        ...

    def jacobian(self, u: Array) -> Array:
        """∂(outputs)/∂(inputs), (..., n) -> (..., k, n)."""
        ...

    @property
    def form(self) -> str:
        """What it is made of, in two words."""
        ...

    @property
    def parameter_count(self) -> int:
        """Numbers that were fitted."""
        ...

    def compiled(self) -> CompiledMapping:
        """The same function as compiled code."""
        ...

    def settings(self) -> dict[str, Any]:
        """What makes this map beside names and arrays, as plain JSON values."""
        ...

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays that make this map, but for the intervals of its inputs."""
        ...


def generalised_force(positions: LearnedMap, eta: Array, force: Array) -> Array:
    """Q = (∂r̂/∂η)ᵀ F, (..., n), for forces (k,) or (..., k) on the outputs r̂ of a map of coordinates η."""
    weighted: Array = np.einsum("...mk,...m->...k", positions.jacobian(eta), force)
    return weighted
