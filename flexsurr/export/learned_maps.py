"""Learned maps as expressions of their inputs."""

import numpy as np

from flexsurr.export.expressions import Value, activation, concat, take
from flexsurr.export.scaled_fields import NotExported, monomials
from flexsurr.surrogates import LearnedMap, NetworkMap, PolynomialMap


def outputs_of_map(learned: LearnedMap, u: Value) -> Value:
    """The outputs (k,) at inputs `u` (n,), both in their units. Raises NotExported for a foreign map."""
    scaled = (u - learned.inputs.origin) * (1.0 / learned.inputs.half)
    if isinstance(learned, PolynomialMap):
        return monomials(learned.exponents, scaled) @ learned.coefficients
    if isinstance(learned, NetworkMap):
        return _network(learned, scaled)
    raise NotExported(f"there are no expressions of a map of the kind {learned.kind}")


def _network(learned: NetworkMap, scaled: Value) -> Value:
    sigma, _ = activation(learned.activation)
    weights, biases, weights_out, biases_out = learned.layers()
    if learned.products:
        first, second = np.array(learned.products).T
        scaled = concat([scaled, take(scaled, first) * take(scaled, second)])
    outputs: Value = sigma(scaled @ weights + biases) @ weights_out + biases_out
    return outputs * learned.outputs.half + learned.outputs.origin
