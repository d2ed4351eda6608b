"""Samples of the aerodynamics, scaled to ±1 and split into those to train and those to validate on."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.storage import Samples

# Apart from what samples are drawn with, so that the split is not the draw's own beginning.
_SPLIT = 1


@dataclass(frozen=True, eq=False)
class CoefficientData:
    """Features u and coefficients y in their units, and which samples are held out to validate on.

    The intervals `input_low` to `input_high` are those the samples were drawn from, `output_low` to
    `output_high` those of the training samples' coefficients: they are −1 to 1 to a network.
    """

    u: Array
    y: Array
    held_out: NDArray[np.bool_]
    input_low: Array
    input_high: Array
    output_low: Array
    output_high: Array
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]
    sha256: str

    @property
    def scaled_u(self) -> Array:
        """Features (m, n) in ±1."""
        return (2.0 * self.u - (self.input_high + self.input_low)) / (self.input_high - self.input_low)

    @property
    def scaled_y(self) -> Array:
        """Coefficients (m, k), those of the training samples in ±1."""
        return (2.0 * self.y - (self.output_high + self.output_low)) / (self.output_high - self.output_low)

    def only(self, outputs: Sequence[str]) -> "CoefficientData":
        """The same samples with some of the outputs, in their order."""
        places = [self.output_names.index(name) for name in outputs]
        return replace(
            self,
            y=self.y[:, places],
            output_low=self.output_low[places],
            output_high=self.output_high[places],
            output_names=tuple(outputs),
        )


def coefficient_data(samples: Samples, held_out: float, seed: int) -> CoefficientData:
    """`samples` with the fraction `held_out` of them, chosen at random by `seed`, to validate on.

    Raises ValueError for a coefficient that does not vary.
    """
    total = len(samples.u)
    kept = np.zeros(total, dtype=np.bool_)
    order = np.random.default_rng([seed, total, _SPLIT]).permutation(total)
    kept[order[: round(held_out * total)]] = True
    y = samples.y[~kept]
    low, high = y.min(axis=0), y.max(axis=0)
    names = samples.metadata.output_names
    if not np.all(low < high):
        raise ValueError(f"{names[int(np.argmin(high - low))]} does not vary over the samples")
    sha256 = hashlib.sha256(repr((samples.metadata.input_names, names)).encode())
    for part in (samples.u, samples.y, kept):
        sha256.update(np.ascontiguousarray(part).tobytes())
    return CoefficientData(
        u=samples.u,
        y=samples.y,
        held_out=kept,
        input_low=np.array(samples.metadata.input_low),
        input_high=np.array(samples.metadata.input_high),
        output_low=low,
        output_high=high,
        input_names=samples.metadata.input_names,
        output_names=names,
        sha256=sha256.hexdigest(),
    )
