"""Coefficients as a linear or a full quadratic form of the features: what a network has to beat."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.archive import read_archive, write_archive

FORMAT = "flexsurr coefficient polynomial 1"
ARRAYS = ("weights", "input_low", "input_high")


@dataclass(frozen=True, eq=False)
class CoefficientPolynomial:
    """Coefficients as a polynomial of degree 1 or 2 in the features, every term of it.

    `weights` (terms, k) are for features scaled to −1 … 1 between `input_low` and `input_high` (n,).
    """

    degree: int
    weights: Array
    input_low: Array
    input_high: Array

    def __call__(self, u: Array) -> Array:
        """Coefficients (m, k) at features `u` (m, n)."""
        low, high = self.input_low, self.input_high
        return terms((2.0 * u - (high + low)) / (high - low), self.degree) @ self.weights

    @property
    def parameters(self) -> Array:
        """All that was fitted."""
        return self.weights.ravel()


def terms(x: Array, degree: int) -> Array:
    """1 and all of scaled features `x` (m, n), or the distinct products of two of these."""
    linear = np.hstack([np.ones((len(x), 1)), x])
    if degree == 1:
        return linear
    first, second = np.triu_indices(linear.shape[1])
    return linear[:, first] * linear[:, second]


def save_coefficient_polynomial(polynomial: CoefficientPolynomial, path: str | Path) -> None:
    """Write `polynomial` to `path` (.npz) whole: beside its place first, then moved there."""
    arrays = {name: getattr(polynomial, name) for name in ARRAYS}
    write_archive(path, FORMAT, {"degree": polynomial.degree}, arrays)


def load_coefficient_polynomial(path: str | Path) -> CoefficientPolynomial:
    """The polynomial in `path`. Raises SurrogateFileError for a damaged or foreign file, OSError for none."""
    return read_archive(
        path,
        FORMAT,
        "a coefficient polynomial",
        lambda header, arrays: CoefficientPolynomial(
            header["degree"], **{name: arrays[name] for name in ARRAYS}
        ),
    )
