"""Learned maps from samples of coordinates and outputs."""

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.learned_map import NetworkMap, PolynomialMap
from flexsurr.surrogates.monomials import evaluate_monomials, monomials_to_degree
from flexsurr.training.levenberg_marquardt import LevenbergMarquardt
from flexsurr.training.structured_normal_equations import CoefficientObjective
from flexsurr.training.triangle import Triangle

_ROUNDING = 1e-12  # an output that varies by less, beside the largest of all, is constant
BLOCK = 4096  # samples at a time


def fit_polynomial_map(
    eta: Array, outputs: Array, output_names: tuple[str, ...], degree: int, even: bool = False
) -> PolynomialMap:
    """Polynomial of total degree ≤ `degree` by least squares; `eta` (samples, r), `outputs` (samples, m).

    `even`: of even powers alone, which is what forces on a symmetric structure have. Raises ValueError where
    a coordinate is zero throughout.
    """
    scales = _reach(eta)
    r = scales.size
    exponents = np.concatenate([np.zeros((1, r), dtype=np.int64), monomials_to_degree(r, degree)])
    if even:
        exponents = exponents[exponents.sum(axis=1) % 2 == 0]
    triangle = Triangle(len(exponents), outputs.shape[1])
    for first in range(0, len(eta), BLOCK):
        part = slice(first, first + BLOCK)
        triangle.add(np.hstack([evaluate_monomials(exponents, eta[part] / scales), outputs[part]]))
    coefficients = triangle.solve().reshape(len(exponents), -1)
    return PolynomialMap(scales, output_names, exponents, coefficients)


def fit_network_map(
    eta: Array,
    outputs: Array,
    output_names: tuple[str, ...],
    hidden: int,
    activation: str,
    epochs: int,
    seed: int = 0,
) -> NetworkMap:
    """Network of one hidden layer by Levenberg–Marquardt; `eta` (samples, r), `outputs` (samples, m).

    Every output counts relative to its spread; one that does not vary is a constant. Raises ValueError where
    a coordinate is zero throughout.
    """
    scales = _reach(eta)
    mean, spread = np.mean(outputs, axis=0), np.std(outputs, axis=0)
    spread = np.where(spread > _ROUNDING * np.max(np.abs(outputs)), spread, 0.0)
    targets = (outputs - mean) / np.where(spread > 0.0, spread, 1.0)
    weights = np.full(spread.size, 1.0 / spread.size)
    objective = CoefficientObjective.of(eta / scales, targets, hidden, activation, weights)
    generator = np.random.default_rng(seed)
    r, m = scales.size, spread.size
    start = [
        generator.standard_normal(r * hidden),
        generator.uniform(-1.0, 1.0, hidden),
        generator.uniform(-1.0, 1.0, hidden * m) / np.sqrt(hidden),
        np.zeros(m),
    ]
    optimiser = LevenbergMarquardt(objective, np.concatenate(start))
    for _ in range(epochs):
        optimiser.epoch()
        if optimiser.finished:
            break
    weights, biases, readout, constant = objective.unpacked(optimiser.parameters)
    return NetworkMap(
        scales,
        output_names,
        activation,
        weights.copy(),
        biases.copy(),
        readout * spread,
        constant * spread + mean,
    )


def _reach(eta: Array) -> Array:
    """Largest size (r,) of each coordinate."""
    scales: Array = np.max(np.abs(eta), axis=0)
    if not np.all(scales > 0.0):
        raise ValueError(f"coordinate {int(np.argmin(scales)) + 1} is zero in every sample")
    return scales
