"""The loss that training reports: nmse."""

import numpy as np

from flexsurr.simulation.rhs import Array


def output_weights(target: Array) -> Array:
    """Weights (d,) with which squared errors of outputs add up to the nmse: 1 / (d · variance).

    `target` is (m, d). Raises ValueError for an output that does not vary: nothing is relative to it.
    """
    variance = np.var(target, axis=0)
    if not np.all(variance > 0.0):
        raise ValueError(f"output {int(np.argmin(variance))} does not vary over the samples")
    return 1.0 / (target.shape[1] * variance)


def nmse(predicted: Array, target: Array) -> float:
    """Mean squared error over the variance of the target, averaged over outputs; both (m, d)."""
    return float(np.mean((predicted - target) ** 2, axis=0) @ output_weights(target))


def nmse_per_state(predicted: Array, target: Array) -> Array:
    """Mean squared error of each output over its target's variance, (m, d) -> (d,); their mean is `nmse`."""
    errors: Array = np.mean((predicted - target) ** 2, axis=0) * output_weights(target) * target.shape[1]
    return errors
