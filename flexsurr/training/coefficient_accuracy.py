"""How well a model of coefficients does, output by output, and where its errors lie."""

import numpy as np
import pandas as pd

from flexsurr.simulation.rhs import Array
from flexsurr.training.coefficient_data import CoefficientData


def accuracy(data: CoefficientData, predicted: Array, model: str) -> pd.DataFrame:
    """A row an output: output, train_nmse, validation_nmse, validation_r2, model.

    `predicted` (m, k) are the coefficients at all samples. nmse is the mean squared error over the
    variance of the target within the same samples; r² is 1 − nmse.
    """
    rows = {}
    for name, chosen in (("train_nmse", ~data.held_out), ("validation_nmse", data.held_out)):
        target = data.y[chosen]
        rows[name] = np.mean((predicted[chosen] - target) ** 2, axis=0) / np.var(target, axis=0)
    frame = pd.DataFrame({"output": data.output_names, **rows})
    frame["validation_r2"] = 1.0 - frame["validation_nmse"]
    frame["model"] = model
    return frame


def held_out_errors(data: CoefficientData, predicted: Array) -> pd.DataFrame:
    """A row a held-out sample: its features by name, and `error_<output>`, over the output's deviation."""
    u, y = data.u[data.held_out], data.y[data.held_out]
    errors = (predicted[data.held_out] - y) / np.std(y, axis=0)
    columns = dict(zip(data.input_names, u.T, strict=True))
    columns |= {f"error_{name}": error for name, error in zip(data.output_names, errors.T, strict=True)}
    return pd.DataFrame(columns)
