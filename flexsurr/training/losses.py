"""The loss that training reports: nmse."""

from collections.abc import Iterable
from typing import Self

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.storage.scales import Moments
from flexsurr.surrogates import Surrogate
from flexsurr.training.dataset import Block, for_each_piece

AS_GOOD = 2.0  # losses within this factor of the least count as equal
EXACT = 1e-28  # an nmse of less is rounding
_ROUNDING = 1e-12  # an output that varies by less, beside the largest of all, is constant


def as_good(loss: float, least: float) -> bool:
    """Whether a model of this nmse counts as good as one of the `least`."""
    return loss <= max(AS_GOOD * least, EXACT)


def output_weights(target: Array) -> Array:
    """Weights (d,) with which squared errors of outputs add up to the nmse: 1 / (d · variance).

    `target` is (m, d). Raises ValueError for an output that does not vary: nothing is relative to it.
    """
    return weights_of_variance(np.var(target, axis=0))


def weights_of_variance(variance: Array) -> Array:
    """The same (d,) from the variance (d,) of each output."""
    if not np.all(variance > 0.0):
        raise ValueError(f"output {int(np.argmin(variance))} does not vary over the samples")
    weights: Array = 1.0 / (variance.size * variance)
    return weights


def spreads(target: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Standard deviations (d,) of `target` (m, d), and a mask of the outputs that do not vary.

    Of those it is the largest size of any output: rounding is all that there is to learn of them.
    """
    largest = float(np.max(np.abs(target))) or 1.0
    spread = np.std(target, axis=0)
    constant = spread <= _ROUNDING * largest
    return np.where(constant, largest, spread), constant


def nmse(predicted: Array, target: Array) -> float:
    """Mean squared error over the variance of the target, averaged over outputs; both (m, d)."""
    return float(np.mean((predicted - target) ** 2, axis=0) @ output_weights(target))


class FieldErrors:
    """The nmse of a surrogate's field, gathered block by block."""

    def __init__(self, surrogate: Surrogate) -> None:
        self._surrogate = surrogate
        count = len(surrogate.state_names)
        self._squares = np.zeros(count)
        self._target = Moments.of(np.empty((0, count)))

    @classmethod
    def over(cls, surrogate: Surrogate, blocks: Iterable[Block]) -> Self:
        """Those over all samples of the blocks."""
        errors = cls(surrogate)
        for_each_piece(blocks, errors.add)
        return errors

    def add(self, x: Array, dx: Array) -> None:
        """Samples of states `x` and derivatives `dx` (m, 2r) in their units."""
        self._squares += np.sum((self._surrogate.derivative(0.0, x) - dx) ** 2, axis=0)
        self._target = self._target.joined(Moments.of(dx))

    def nmse_per_state(self) -> Array:
        """Mean squared error of each rate over its variance (2r,); their mean is `nmse`."""
        variance = self._target.variance
        errors: Array = self._squares / self._target.rows * weights_of_variance(variance) * variance.size
        return errors

    def nmse(self) -> float:
        """Their mean."""
        return float(np.mean(self.nmse_per_state()))
