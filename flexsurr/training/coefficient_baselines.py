"""Linear and full quadratic least squares: what a network of coefficients has to beat."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lstsq

from flexsurr.simulation.rhs import Array
from flexsurr.training.coefficient_data import CoefficientData


@dataclass(frozen=True, eq=False)
class CoefficientPolynomial:
    """Coefficients as a polynomial of degree 1 or 2 in the features; `weights` (terms, k) for scaled ones."""

    degree: int
    weights: Array
    low: Array
    high: Array

    def __call__(self, u: Array) -> Array:
        """Coefficients (m, k) at features `u` (m, n)."""
        return _terms((2.0 * u - (self.high + self.low)) / (self.high - self.low), self.degree) @ self.weights


def fit_coefficient_polynomial(data: CoefficientData, degree: int) -> CoefficientPolynomial:
    """The polynomial with the least squared errors over the training samples, every term of it unknown."""
    x, y = data.scaled_u[~data.held_out], data.y[~data.held_out]
    weights, *_ = lstsq(_terms(x, degree), y)
    return CoefficientPolynomial(degree, weights, data.input_low, data.input_high)


def _terms(x: Array, degree: int) -> Array:
    """1 and all features, or the distinct products of two of these."""
    linear = np.hstack([np.ones((len(x), 1)), x])
    if degree == 1:
        return linear
    first, second = np.triu_indices(linear.shape[1])
    return linear[:, first] * linear[:, second]
