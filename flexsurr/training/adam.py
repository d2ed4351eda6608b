"""Adam (Kingma & Ba 2015, algorithm 1) and AdamW (Loshchilov & Hutter 2019) over mini-batches, as in torch.

An epoch goes once through the samples in a random order, the last batch being what is left over. The
gradient is closed-form and the whole epoch is compiled; nothing else differs from the study's training
loop in torch. The tests hold it against torch.optim.Adam.
"""

import math
from dataclasses import replace

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.training.batches import CACHED, loss_and_gradient
from flexsurr.training.objective import Objective

BETA_1 = 0.9
BETA_2 = 0.999
EPSILON = 1e-8


class Adam:
    """Adam with a constant rate, or one that falls to 0 over `epochs` as half a cosine.

    A step shrinks the weights by `weight_decay` times the rate beforehand (AdamW), or by nothing.
    `precision` is that of weights, data and moments: "single" as torch has it by default, or "double".
    Satisfies `Optimiser`.
    """

    finished = ""

    def __init__(
        self,
        objective: Objective,
        parameters: Array,
        *,
        learning_rate: float,
        batch_size: int,
        epochs: int,
        cosine: bool,
        weight_decay: float = 0.0,
        precision: str,
        seed: int,
    ) -> None:
        number: type = np.float32 if precision == "single" else np.float64
        self.parameters: Array = parameters.astype(number)
        self._objective = replace(objective, x=objective.x.astype(number), y=objective.y.astype(number))
        self._learning_rate, self._batch_size = learning_rate, batch_size
        self._epochs, self._cosine, self._seed = epochs, cosine, seed
        self._weight_decay = weight_decay
        self._first = np.zeros_like(self.parameters)
        self._second = np.zeros_like(self.parameters)
        self._done = 0
        self._pass(np.arange(0), 0.0)  # compiles; an epoch's time is then its own

    def epoch(self) -> float:
        """One pass over the samples; the mean of the batches' losses."""
        samples = len(self._objective.x)
        rate = self._learning_rate
        if self._cosine:
            rate *= 0.5 * (1.0 + math.cos(math.pi * self._done / self._epochs))
        # the order is a function of seed and epoch: a resumed run needs no state of a generator
        order = np.random.default_rng([self._seed, self._done]).permutation(samples)
        loss = self._pass(order, rate)
        self._done += 1
        return loss

    def _pass(self, order: NDArray[np.int64], rate: float) -> float:
        loss: float = _epoch(
            self._objective.kernel(self.parameters),
            self._objective.x,
            self._objective.y,
            self._objective.step_weights,
            order,
            self._batch_size,
            rate,
            rate * self._weight_decay,
            self._done * -(-len(self._objective.x) // self._batch_size),
            self.parameters,
            self._first,
            self._second,
            self._objective.workspace,
        )
        return loss

    def state(self) -> dict[str, Array]:
        """Weights, both moments and the number of epochs."""
        return {
            "parameters": self.parameters,
            "first": self._first,
            "second": self._second,
            "done": np.array(self._done),
        }

    def restore(self, state: dict[str, Array]) -> None:
        """Go on from a `state`."""
        self.parameters = state["parameters"].copy()
        self._first, self._second = state["first"].copy(), state["second"].copy()
        self._done = int(state["done"])


@njit(**CACHED)
def _epoch(kernel, x, y, weights, order, batch_size, rate, decay, steps, parameters, first, second, work):
    gradient = np.zeros_like(parameters)
    total = 0.0
    for start in range(0, order.size, batch_size):
        chosen = order[start : start + batch_size]
        total += chosen.size * loss_and_gradient(kernel, x, y, weights, chosen, gradient, work)
        steps += 1
        size = rate / (1.0 - BETA_1**steps)
        root = math.sqrt(1.0 - BETA_2**steps)
        for i in range(parameters.size):
            g = gradient[i]
            first[i] = BETA_1 * first[i] + (1.0 - BETA_1) * g
            second[i] = BETA_2 * second[i] + (1.0 - BETA_2) * g * g
            parameters[i] -= decay * parameters[i] + size * first[i] / (math.sqrt(second[i]) / root + EPSILON)
    return total / order.size
