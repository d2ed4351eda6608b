"""How large the states and their rates are: what every scaling is computed from."""

from dataclasses import dataclass

import numpy as np

from flexsurr.storage.moments import Array, Moments


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
