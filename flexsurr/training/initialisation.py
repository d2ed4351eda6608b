"""Random weights to start from."""

import math
from typing import Literal

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import Network
from flexsurr.surrogates.layers import layer_shapes, views

WIDE = 2.0


def initial_parameters(
    form: type[Network], states: int, hidden: tuple[int, ...], spread: Literal["torch", "wide"], seed: int
) -> Array:
    """Weights for a network of class `form`.

    torch: as torch.nn.Linear draws them, uniform within ±1/√inputs. wide: normal hidden weights and
    uniform biases twice the size of the scaled inputs, so that the neurons' bends lie all over them;
    second-order methods, which are not upset by large weights, start nearer to their end there.
    """
    generator = np.random.default_rng(seed)
    shapes = form.shapes(states, hidden)
    pieces, inputs = [], states
    for number, shape in enumerate(shapes):
        place = number % (len(shapes) // form.networks)
        is_hidden = place < 2 * len(hidden)
        if len(shape) == 2 or not is_hidden:
            inputs = shape[0] if place else states
        if spread == "torch" or not is_hidden:
            piece = generator.uniform(-1.0, 1.0, shape) / math.sqrt(inputs)
        elif len(shape) == 2:
            piece = WIDE * generator.standard_normal(shape) / (math.sqrt(inputs) if place else 1.0)
        else:
            piece = WIDE * generator.uniform(-1.0, 1.0, shape)
        pieces.append(piece.ravel())
    return np.concatenate(pieces)


def initial_weights(inputs: int, hidden: int, outputs: int, seed: int, spread: float) -> Array:
    """Weights for a map of one hidden layer: normal ones of the deviation `spread`, and uniform biases.

    The outputs read the neurons by small weights, without biases.
    """
    generator = np.random.default_rng(seed)
    parameters = np.zeros((inputs + 1) * hidden + (hidden + 1) * outputs)
    weights, biases, weights_out, _ = views(parameters, layer_shapes((inputs, hidden, outputs)))
    weights[:] = generator.standard_normal(weights.shape) * spread
    biases[:] = generator.uniform(-1.0, 1.0, biases.shape)
    weights_out[:] = generator.uniform(-1.0, 1.0, weights_out.shape) / math.sqrt(hidden)
    return parameters
