"""Samples of a map, split into those to train and those to validate on; and how well a map does on them."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.storage import Samples
from flexsurr.surrogates import Intervals

# Apart from what samples are drawn with, so that the split is not the draw's own beginning.
_SPLIT = 1


@dataclass(frozen=True, eq=False)
class MapData:
    """Inputs u (m, n) and outputs y (m, k) in their units, and which samples are held out to validate on.

    The inputs' intervals are those the samples were drawn from, the outputs' those of the training samples.
    """

    u: Array
    y: Array
    held_out: NDArray[np.bool_]
    inputs: Intervals
    outputs: Intervals
    sha256: str

    @property
    def scaled_u(self) -> Array:
        """Inputs (m, n) in ±1."""
        return self.inputs.scaled(self.u)

    @property
    def scaled_y(self) -> Array:
        """Outputs (m, k), those of the training samples in ±1."""
        return self.outputs.scaled(self.y)

    def only(self, outputs: Sequence[str]) -> "MapData":
        """The same samples with some of the outputs, in their order."""
        places = [self.outputs.names.index(name) for name in outputs]
        return replace(self, y=self.y[:, places], outputs=self.outputs.only(outputs))


def map_data(samples: Samples, held_out: float, seed: int) -> MapData:
    """`samples` with the fraction `held_out` of them, chosen at random by `seed`, to validate on.

    Raises ValueError for an output that does not vary.
    """
    total, metadata = len(samples.u), samples.metadata
    kept = np.zeros(total, dtype=np.bool_)
    order = np.random.default_rng([seed, total, _SPLIT]).permutation(total)
    kept[order[: round(held_out * total)]] = True
    y = samples.y[~kept]
    low, high = y.min(axis=0), y.max(axis=0)
    if not np.all(low < high):
        raise ValueError(
            f"{metadata.output_names[int(np.argmin(high - low))]} does not vary over the samples"
        )
    sha256 = hashlib.sha256(repr((metadata.input_names, metadata.output_names)).encode())
    for part in (samples.u, samples.y, kept):
        sha256.update(np.ascontiguousarray(part).tobytes())
    return MapData(
        samples.u,
        samples.y,
        kept,
        Intervals(metadata.input_names, np.array(metadata.input_low), np.array(metadata.input_high)),
        Intervals(metadata.output_names, low, high),
        sha256.hexdigest(),
    )


def nmse_per_output(predicted: Array, target: Array) -> Array:
    """Mean squared error of each output over its variance (k,); both (m, k)."""
    errors: Array = np.mean((predicted - target) ** 2, axis=0) / np.var(target, axis=0)
    return errors


def accuracy(data: MapData, predicted: Array, model: str) -> pd.DataFrame:
    """A row an output: output, train_nmse, validation_nmse, validation_r2, model.

    `predicted` (m, k) are the outputs at all samples. nmse is the mean squared error over the variance of
    the target within the same samples; r² is 1 − nmse.
    """
    rows = {
        name: nmse_per_output(predicted[chosen], data.y[chosen])
        for name, chosen in (("train_nmse", ~data.held_out), ("validation_nmse", data.held_out))
    }
    frame = pd.DataFrame({"output": data.outputs.names, **rows})
    frame["validation_r2"] = 1.0 - frame["validation_nmse"]
    frame["model"] = model
    return frame


def held_out_errors(data: MapData, predicted: Array) -> pd.DataFrame:
    """A row a held-out sample: its inputs by name, and `error_<output>`, over the output's deviation."""
    u, y = data.u[data.held_out], data.y[data.held_out]
    errors = (predicted[data.held_out] - y) / np.std(y, axis=0)
    columns = dict(zip(data.inputs.names, u.T, strict=True))
    columns |= {f"error_{name}": error for name, error in zip(data.outputs.names, errors.T, strict=True)}
    return pd.DataFrame(columns)
