"""How large states and their rates are, by which they are scaled: gathered block by block."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Moments:
    """Of columns (d,): number of rows, mean, sum of squared deviations from it, least and largest."""

    rows: int
    mean: Array
    squares: Array
    low: Array
    high: Array

    @classmethod
    def of(cls, values: Array) -> "Moments":
        """The moments of one block `values` (m, d)."""
        if not len(values):
            zero = np.zeros(values.shape[1])
            return cls(0, zero, zero, zero + np.inf, zero - np.inf)
        mean = values.mean(axis=0)
        squares = np.square(values - mean).sum(axis=0)
        return cls(len(values), mean, squares, values.min(axis=0), values.max(axis=0))

    def joined(self, other: "Moments") -> "Moments":
        """The moments of both blocks together (Chan, Golub & LeVeque 1983, eq. 1.5)."""
        rows = self.rows + other.rows
        if rows == 0:
            return self
        difference = other.mean - self.mean
        mean = self.mean + difference * (other.rows / rows)
        squares = self.squares + other.squares + np.square(difference) * (self.rows * other.rows / rows)
        low, high = np.minimum(self.low, other.low), np.maximum(self.high, other.high)
        return Moments(rows, mean, squares, low, high)

    @property
    def variance(self) -> Array:
        """Population variance of each column (d,); zero where there are no rows."""
        return self.squares / max(self.rows, 1)


@dataclass(frozen=True)
class Scales:
    """Of samples, in the order x, then dx (2d,): mean, standard deviation, least and largest value."""

    mean: tuple[float, ...]
    standard_deviation: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]

    @classmethod
    def of(cls, x: Array, dx: Array) -> "Scales":
        """Of states `x` and their derivatives `dx` (m, d)."""
        return cls.of_moments(Moments.of(np.hstack([x, dx])))

    @classmethod
    def of_moments(cls, moments: Moments) -> "Scales":
        """Of the `moments` of the columns x, then dx (2d,)."""
        return cls(
            tuple(moments.mean.tolist()),
            tuple(np.sqrt(moments.variance).tolist()),
            tuple(moments.low.tolist()),
            tuple(moments.high.tolist()),
        )

    @property
    def largest(self) -> Array:
        """The largest size (2d,)."""
        return np.maximum(np.abs(self.low), np.abs(self.high))

    @property
    def root_mean_square(self) -> Array:
        """√(mean² + standard deviation²) (2d,)."""
        return np.hypot(self.mean, self.standard_deviation)
